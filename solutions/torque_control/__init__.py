"""Notebook 04: controllers that command torques."""
