"""Studies: tasks, many runs of them, and what they say when put side by side."""
