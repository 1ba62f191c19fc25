"""Notebook 01: paths and time scalings."""
