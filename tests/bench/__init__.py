"""The speed of labkit compared with loops by hand and by others: `python -m tests.bench`."""
