"""Labels of the bibliography, with the format of citations: Hogan, 1985; Pham and Pham, 2018."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any

from pybtex.plugin import register_plugin
from pybtex.style.formatting.plain import Style
from pybtex.style.labels import BaseLabelStyle

NAME = "author-year"


class AuthorYear(BaseLabelStyle):
    """Labels made of the last names and the year."""

    def format_labels(self, entries: Iterable[Any]) -> Iterator[str]:
        """Return a label for each entry."""
        for entry in entries:
            names = [" ".join(map(str, x.rich_last_names)) for x in entry.persons["author"]]
            who = f"{names[0]} et al." if len(names) > 2 else " and ".join(names)
            yield f"{who}, {entry.fields['year'].replace('--', '-')}"


class Labelled(Style):
    """The plain bibliography style with these labels."""

    default_label_style = NAME


def register() -> None:
    """Register the style under its name."""
    register_plugin("pybtex.style.labels", NAME, AuthorYear)
    register_plugin("pybtex.style.formatting", NAME, Labelled)
