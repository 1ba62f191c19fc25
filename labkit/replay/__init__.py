"""Replays of runs, in a notebook or on a page, with one viewer."""

from __future__ import annotations

from .figure import recorded_html, viewer_scripts
from .motion import Motion
from .recorded import motion_of
from .view import live
from .widget import show

__all__ = ["Motion", "live", "motion_of", "recorded_html", "show", "viewer_scripts"]
