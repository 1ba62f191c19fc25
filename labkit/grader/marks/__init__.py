"""Each student's mark, line by line, from the gradebook, and tables of marks."""
