"""Notebook 02: the equations of motion."""
