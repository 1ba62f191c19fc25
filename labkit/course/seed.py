"""The seed of the demonstration."""

PUBLIC_SEED = 2019
"""It is not a secret, so the hidden cases that are made with it are not hidden."""
