"""For instructors: release assignments, grade submissions, read what the class misunderstood."""
