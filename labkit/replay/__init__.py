"""Replays of runs, in a notebook or on a page, with one viewer."""

from __future__ import annotations

from .motion import Motion, motion_of
from .player import figure_html, show, viewer_scripts
from .session import live

__all__ = ["Motion", "figure_html", "live", "motion_of", "show", "viewer_scripts"]
