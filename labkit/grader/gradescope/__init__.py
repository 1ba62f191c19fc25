"""Gradescope: the zip that it asks for, and what runs in its container."""
