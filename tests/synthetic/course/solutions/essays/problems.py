"""A notebook of texts alone."""

PROBLEMS = ()
