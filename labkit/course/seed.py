"""The seed of the demonstration."""

PUBLIC_SEED = 2019
"""This seed is public, so hidden cases that are drawn from it can be known."""
