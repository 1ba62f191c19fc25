"""The concept test: twelve items in two forms, on paper and for Moodle and Canvas.

Moodle reads its own XML (docs.moodle.org/en/Moodle_XML_format).  Canvas reads a zip of QTI 1.2, the
format of the 1EdTech consortium (imsglobal.org/question/qtiv1p2), with its own field
``question_type`` (canvas.instructure.com/doc, "Quizzes, import QTI package").
"""

from __future__ import annotations

import io
import tomllib
import zipfile
from collections.abc import Sequence
from hashlib import sha256
from typing import Any, Literal

import msgspec

from ...course.authoring.layout import Course
from ...course.authoring.outcomes import check_outcomes
from ...errors import LabkitError
from ..pages import file, render, render_page

FILE = "solutions/concepts.toml"
Form = Literal["a", "b"]


class Wording(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One form of an item: the question, the right answer, and three wrong answers."""

    asks: str
    right: str
    wrong: tuple[str, str, str]


class Item(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One item.

    Attributes:
        name: A name in a few words.
        outcome: A name of `outcomes.OUTCOMES`.
        because: Why a student may choose each wrong answer; see the file.
        a: Form A.
        b: Form B.
    """

    name: str
    outcome: str
    because: tuple[str, str, str]
    a: Wording
    b: Wording


def items(course: Course) -> tuple[Item, ...]:
    """The items of the course.

    Raises:
        LabkitError: The file is missing or not valid.
    """
    path = course.root / FILE
    try:
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        found = msgspec.convert(data["item"], tuple[Item, ...])
    except FileNotFoundError:
        raise LabkitError(f"there is no concept test; write {path}") from None
    except (ValueError, KeyError) as error:
        raise LabkitError(f"{path}: {error}; correct that") from None
    for item in found:
        check_outcomes(path, item.name, (item.outcome,))
    return found


def asked(course: Course, form: Form) -> list[dict[str, Any]]:
    """One form of the test, for the templates; the order of its options never changes.

    Returns:
        For each item, its ``number``, ``name`` and ``outcome``, the question it ``asks``, the
        ``options``, and the ``key``, which is the letter of the right option.  Each option has a
        ``letter``, a ``text``, whether it is ``right``, and what it ``says`` if it is wrong.
    """
    known = {
        f"{problem.name}: {wrong.name}": wrong.says
        for name in course.names()
        for problem in course.problems(name)
        for wrong in problem.wrong
    }
    test = []
    for number, item in enumerate(items(course), start=1):
        wording = item.a if form == "a" else item.b
        options = _options(wording, [known.get(because, because) for because in item.because])
        (key,) = (option["letter"] for option in options if option["right"])
        about = {"number": number, "name": item.name, "outcome": item.outcome, "key": key}
        test.append(about | {"asks": wording.asks, "options": options})
    return test


def _options(wording: Wording, because: Sequence[str]) -> list[dict[str, Any]]:
    """The answers to choose from, in an order that depends only on their texts."""
    says = {wording.right: "", **dict(zip(wording.wrong, because, strict=True))}
    order = sorted(says, key=lambda text: sha256(f"{wording.asks}{text}".encode()).digest())
    return [
        {"letter": letter, "text": text, "says": says[text], "right": text == wording.right}
        for letter, text in zip("abcd", order, strict=True)
    ]


def paper(course: Course, form: Form) -> bytes:
    """A form as HTML for printing, with the key on a separate page."""
    test = asked(course, form)
    return render_page("concepts.html.j2", file("concepts.css"), form=form, test=test).encode()


def moodle(course: Course, form: Form) -> bytes:
    """A form as Moodle's XML, for its question bank; each wrong answer has its feedback."""
    return render("concepts_moodle.xml.j2", form=form, test=asked(course, form)).encode()


def canvas(course: Course, form: Form) -> bytes:
    """A form as a zip of QTI 1.2, for Canvas."""
    out, name = io.BytesIO(), f"concepts_{form}"
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("imsmanifest.xml", render("concepts_manifest.xml.j2", name=name))
        quiz = render("concepts_canvas.xml.j2", name=name, form=form, test=asked(course, form))
        archive.writestr(f"{name}/{name}.xml", quiz)
    return out.getvalue()


LAYOUTS = {"paper": paper, "moodle-quiz": moodle, "canvas-quiz": canvas}
"""The function that writes the test, by the layout of ``labkit export``."""
