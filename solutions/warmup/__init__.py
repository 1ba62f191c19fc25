"""Notebook 00: errors, frames, orientation."""
