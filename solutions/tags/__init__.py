"""Notebook 06: tags, and following one."""
