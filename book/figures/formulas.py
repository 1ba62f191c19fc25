"""Formulas as MathML, which browsers draw by themselves, without a script."""

from __future__ import annotations

import re

from math_core import LatexToMathML

_CONVERTER = LatexToMathML(macros={"SE": r"\mathrm{SE}", "SO": r"\mathrm{SO}", "R": r"\mathbb{R}"})


def mathml(formula: str, *, block: bool = False) -> str:
    """A formula of LaTeX as an element of HTML.

    Raises:
        math_core.LatexError: The formula has a fault, which ends the build.
    """
    if block and r"\begin" not in formula and ("&" in formula or r"\\" in formula):
        formula = rf"\begin{{aligned}}{formula}\end{{aligned}}"  # as Sphinx reads several lines
    return _CONVERTER.convert_with_local_state(formula, displaystyle=block)


def in_text(text: str) -> str:
    """A text of HTML in which formulas stand between \\( and \\)."""
    return re.sub(r"\\\((.+?)\\\)", lambda found: mathml(found[1]), text)
