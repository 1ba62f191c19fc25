"""Replays of runs, in a notebook or on a page, with one viewer."""

from __future__ import annotations

from .motion import Motion, motion_of
from .player import recorded_html, show, viewer_scripts
from .view import live

__all__ = ["Motion", "live", "motion_of", "recorded_html", "show", "viewer_scripts"]
