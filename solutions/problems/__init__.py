"""What is asked: one module of problems for each notebook."""
