"""Notebook 03: controllers that command speeds."""
