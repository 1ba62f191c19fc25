"""How quick labkit is, against loops written by hand and by others: `python -m tests.bench`."""
