"""The concept test: twelve items in two forms, on paper and for Moodle and Canvas.

Moodle reads its own XML (docs.moodle.org/en/Moodle_XML_format).  Canvas reads a zip of QTI 1.2, the
format of the 1EdTech consortium (imsglobal.org/question/qtiv1p2), with its own field
``question_type`` (canvas.instructure.com/doc, "Quizzes, import QTI package").
"""

from __future__ import annotations

import hashlib
import io
import tomllib
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import msgspec

from ...course.layout import Course
from ...course.outcomes import OUTCOMES
from ...errors import LabkitError
from ..pages import file, policy, render

FILE = "solutions/concepts.toml"
Form = Literal["a", "b"]


class Wording(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One form of an item: what it asks, the right answer, three wrong ones."""

    asks: str
    right: str
    wrong: tuple[str, str, str]


class Item(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """One item.

    Attributes:
        name: In a few words.
        outcome: A name of `outcomes.OUTCOMES`.
        because: Why somebody chooses each wrong answer; see the file.
        a: Form A.
        b: Form B.
    """

    name: str
    outcome: str
    because: tuple[str, str, str]
    a: Wording
    b: Wording


@dataclass(frozen=True)
class Option:
    """An answer to choose: its letter, its text, what to say of it, whether it is right."""

    letter: str
    text: str
    says: str
    right: bool


@dataclass(frozen=True)
class FormItem:
    """One item as it is asked in a form."""

    number: int
    name: str
    outcome: str
    asks: str
    options: tuple[Option, ...]

    @property
    def key(self) -> str:
        """The letter of the right answer."""
        return next(option.letter for option in self.options if option.right)


def items(course: Course) -> tuple[Item, ...]:
    """The items of the course.

    Raises:
        LabkitError: The file is missing, or it is not as it should be.
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
        if item.outcome not in OUTCOMES:
            known = ", ".join(OUTCOMES)
            raise LabkitError(f"{path}: {item.outcome!r} is not an outcome; there are {known}")
    return found


def asked(course: Course, form: Form) -> tuple[FormItem, ...]:
    """One form of the test; its options have the same order each time."""
    known = {
        f"{problem.name}: {wrong.name}": wrong.says
        for name in course.names()
        for problem in course.problems(name)
        for wrong in problem.wrong
    }
    return tuple(
        FormItem(
            number, item.name, item.outcome, wording.asks, tuple(_options(wording, item, known))
        )
        for number, item in enumerate(items(course), start=1)
        for wording in [item.a if form == "a" else item.b]
    )


def _options(wording: Wording, item: Item, known: dict[str, str]) -> Iterator[Option]:
    texts = {wording.right: "", **dict(zip(wording.wrong, item.because, strict=True))}
    order = sorted(
        texts, key=lambda text: hashlib.sha256(f"{wording.asks}{text}".encode()).digest()
    )
    for letter, text in zip("abcd", order, strict=True):
        because = texts[text]
        yield Option(letter, text, known.get(because, because), text == wording.right)


def paper(course: Course, form: Form) -> bytes:
    """A form to print, as HTML, and the key on a page of its own."""
    style = file("feedback.css") + file("concepts.css")
    test = asked(course, form)
    page = render(
        "concepts.html.j2", form=form, test=test, style=style, policy=policy(style, ()),
        outcomes=OUTCOMES,
    )  # fmt: skip
    return page.encode()


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
"""How the test is written, by the layout of ``labkit export``."""
