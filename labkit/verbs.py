"""What the verbs of the command line share: how one is added, and the numbers that it takes."""

from __future__ import annotations

import argparse
from collections.abc import Callable
from typing import Any

Verbs = Any
"""What `argparse.ArgumentParser.add_subparsers` gives, which has no public type."""


Do = Callable[[argparse.Namespace], int]
"""Does what a verb says, and gives the exit code."""


def add_verb(verbs: Verbs, name: str, do: Do, does: str, example: str) -> argparse.ArgumentParser:
    """Add a verb.

    Args:
        verbs: The others.
        name: What one types.
        do: Does it.
        does: What it does, in a few words.
        example: What may stand behind the name.

    Returns:
        Its parser, for the arguments.
    """
    verb: argparse.ArgumentParser = verbs.add_parser(
        name,
        help=does,
        description=f"{does[0].upper()}{does[1:]}{'' if does.endswith('?') else '.'}",
        epilog=f"example: labkit {name} {example}".rstrip(),
    )
    verb.set_defaults(do=do)
    return verb


def whole(least: int) -> Callable[[str], int]:
    """Reads an argument that is a whole number, ``least`` or more."""

    def read(text: str) -> int:
        if not text.isdecimal() or int(text) < least:
            raise argparse.ArgumentTypeError(f"{text} is no whole number from {least} up")
        return int(text)

    return read
