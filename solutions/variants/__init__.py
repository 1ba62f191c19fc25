"""Right answers written otherwise, which every check must accept: one module for each notebook."""
