"""The physics engines behind one protocol; each engine has one module that imports it."""

from .engine import Engine

__all__ = ["Engine"]
