"""A run made visible: in the book's pages and in the notebook, by one viewer."""

from __future__ import annotations

from .motion import Motion
from .page import (
    Dial,
    Explorer,
    demo_html,
    explorer_html,
    motion_html,
    recorded_html,
    run_files,
    shared_files,
    viewer_scripts,
)
from .recorded import motion_of
from .widget import demo, show

__all__ = [
    "Dial",
    "Explorer",
    "Motion",
    "demo",
    "demo_html",
    "explorer_html",
    "motion_html",
    "motion_of",
    "recorded_html",
    "run_files",
    "shared_files",
    "show",
    "viewer_scripts",
]
