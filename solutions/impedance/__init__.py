"""Notebook 05: impedance at the joints and at the tip."""
