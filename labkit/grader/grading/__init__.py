"""From a submission to its result: what runs, who marks it, and a class at a time."""
