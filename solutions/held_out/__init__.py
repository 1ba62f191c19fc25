"""Makers of the hidden cases, functions of a generator: one module for each notebook."""
