"""Notebook 07: comparing controllers, and choosing gains."""
