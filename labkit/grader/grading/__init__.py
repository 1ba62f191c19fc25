"""Everything from a submission to its result, for one notebook and for a whole class."""
