"""Tags, the boards that carry them, the cameras that see them, and pose estimates from pictures."""

from __future__ import annotations

from .camera import Camera, looking_at
from .detection import detect_tags
from .drawing import Intrinsics
from .stream import TagStream, TagTarget
from .tag import Board, Tag

__all__ = [
    "Board", "Camera", "Intrinsics", "Tag", "TagStream", "TagTarget", "detect_tags", "looking_at",
]  # fmt: skip
