"""The laws that must hold after every command, whatever students handed in."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Iterator, Mapping, Sequence
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import nbformat

from labkit.grader.marks.export import IDENTITIES

from .classes import HONEST, NAME
from .commands import Ended

LARGEST = 2_000_000
"""The largest size of a result file, in bytes."""
_UNSAFE = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069\ufeff\ud800-\udfff]")
"""Characters that a terminal obeys, that reverse the writing direction, or that are not UTF-8."""
_TRACEBACK = "Traceback (most recent call last)"
_CHAINED = re.compile(r"exception (occurred|was the direct cause of the following exception):\s*$")
_REFUSAL = re.compile(
    r"/nbformat/|/dateutil/|in get_existing_timestamp|^\s*IsADirectoryError: "
    r"|^\s*UnicodeEncodeError: .*surrogates|NbGraderException: |^\s*labkit\.[\w.]+: \w",
    re.MULTILINE,
)
"""Allowed in nbgrader's traceback about a submission, because nbgrader has no other form for the
reason: the file is not a notebook, its time is not a time, its name is not text, or nbgrader or
labkit refuses it in a sentence."""
_WARNING = re.compile(r"^\S+\.py:\d+: \w*Warning", re.MULTILINE)
_VOID = frozenset(
    ["area", "base", "br", "col", "embed", "hr", "img", "input", "link", "meta", "source", "wbr"]
)
_WRITTEN = ("results", "feedback", "autograded", "course_private", "aside")
"""Folders of a course that commands write to."""


def said(ended: Ended, codes: Sequence[int] = (0, 1)) -> Iterator[str]:
    """The faults in the exit code and in the output of a command."""
    yield from (says for _, says in told(ended, codes))


def told(ended: Ended, codes: Sequence[int] = (0, 1)) -> Iterator[tuple[str, str]]:
    """These faults, each with the line that may name the responsible student."""
    typed = " ".join(ended.words[:2])
    if ended.code is None:
        yield "", f"{typed}: hung and had to be ended"
    elif ended.code not in codes:
        yield "", f"{typed}: exit code {ended.code}: {_last(ended.err)}"
    elif ended.code and not ended.text.strip():
        yield "", f"{typed}: exit code {ended.code}, and nothing is named"
    if ended.code == 2 and ended.words[0] == "labkit":
        lines = ended.err.decode("utf-8", "replace").strip().split("\n")
        if not lines[-1].startswith(f"{typed}: "):
            yield "", f"{typed}: exit code 2 without a sentence: {_last(ended.err)}"
    before, *raised = ended.text.split(_TRACEBACK)
    blamed = ""
    for text in raised:
        blamed = blamed if _CHAINED.search(before) else _blamed(before)
        if ended.words[0] != "nbgrader" or not (blamed and _REFUSAL.search(text)):
            yield blamed, f"{typed}: a traceback: {_raised(text)}"
        before = text
    if ended.words[0] == "labkit" and (found := _WARNING.search(ended.text)):
        yield "", f"{typed}: a warning of Python's: {found.group()}"
    for line in ended.text.split("\n"):
        if found := _UNSAFE.search(line):
            yield line, f"{typed}: {found.group()!a} on the terminal: {line[:200]!a}"


def _blamed(before: str) -> str:
    """The line in which nbgrader names the student whose work made it fail."""
    said = [x for x in before.split("\n")[-3:] if "There was an error processing" in x]
    return said[-1] if said else ""


def _last(text: bytes) -> str:
    lines = text.decode("utf-8", "replace").strip().split("\n")
    return ascii(lines[-1][:300])[1:-1]


def _raised(text: str) -> str:
    """The line of a traceback that names the exception."""
    lines = text.split("\n")[1:]
    ends = [line for line in lines if re.match(r"\s*[\w.]+(Error|Exception|Exit)\b", line)]
    return ascii((ends or lines or [""])[0][:300])[1:-1]


def written(course: Path, since: float, name: str = NAME) -> Iterator[tuple[Path, str]]:
    """The faults in the files that commands have written, each with its path."""
    for place in (course, course.parent):
        yield from ((path, "was written outside") for path in place.glob("owned*"))
    for top in _WRITTEN:
        for path in sorted((course / top).rglob("*")):
            if path.is_symlink() or not path.is_file() or path.stat().st_mtime < since:
                continue
            if top == "autograded" and path.name != f"{name}.ipynb":
                continue  # nbgrader copies all other files of a submission
            if top == "results" and path.stat().st_size > LARGEST:
                yield path, f"a result of {path.stat().st_size / 1e6:.1f} MB"
            yield from ((path, says) for says in look_at(path))


def look_at(path: Path) -> Iterator[str]:
    """The faults in a file, if its kind can be read."""
    if path.suffix not in _LOOKS:
        return
    try:
        text = path.read_bytes().decode("utf-8")
    except UnicodeDecodeError as error:
        yield f"no UTF-8: {error}"
    else:
        kind = path.suffix[1:]
        yield from (f"{kind}: {says}" for says in _LOOKS[path.suffix](text))


def _anything(text: str) -> Iterator[str]:
    yield from ()


def _json(text: str) -> Iterator[str]:
    def constant(name: str) -> None:
        raise ValueError(f"{name} is no JSON")

    try:
        json.loads(text, parse_constant=constant)
    except (ValueError, RecursionError) as error:
        yield f"cannot be read: {error}"


def _notebook(text: str) -> Iterator[str]:
    try:
        nbformat.validate(nbformat.reads(text, as_version=4))
    except Exception as error:
        yield f"no notebook: {type(error).__name__}: {str(error)[:100]}"


def _plain(text: str) -> Iterator[str]:
    if found := _UNSAFE.search(text):
        yield f"holds {found.group()!a}"


def _page(text: str) -> Iterator[str]:
    yield from _plain(text.translate({ord("\r"): "\n", ord("\f"): "\n"}))  # white space in HTML
    page = _Page()
    page.feed(text)
    page.close()
    yield from page.wrong
    if page.open:
        yield f"<{page.open[-1]}> is not closed"


class _Page(HTMLParser):
    """Checks that elements are nested correctly and that students have written none of them."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.wrong: list[str] = []

    def handle_starttag(self, tag: str, attrs: Sequence[tuple[str, str | None]]) -> None:
        live = [x for x, _ in attrs if x.startswith("on") or x in {"href", "src", "srcdoc"}]
        if live and any("hostile()" in (value or "") for _, value in attrs):
            self.wrong.append(f"live: <{tag} {attrs!a:.100}>")
        if tag not in _VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: Sequence[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        self.handle_endtag(tag)

    def handle_endtag(self, tag: str) -> None:
        if self.open and self.open[-1] == tag:
            self.open.pop()
        elif tag not in _VOID:
            self.wrong.append(f"</{tag}> closes <{self.open[-1] if self.open else ''}>")

    def handle_data(self, data: str) -> None:
        if self.open and self.open[-1] in {"script", "style"} and "hostile()" in data:
            self.wrong.append(f"live: <{self.open[-1]}>{data[:60]!a}")


_LOOKS = {
    ".json": _json,
    ".ipynb": _notebook,
    ".html": _page,
    ".md": _plain,
    ".csv": _plain,
    ".py": _anything,
}


def table(ended: Ended) -> Iterator[str]:
    """The faults in an exported table."""
    rows = list(csv.reader(io.StringIO(ended.out.decode("utf-8", "replace"), newline="")))
    if len({len(row) for row in rows}) > 1:
        yield "export: rows of different lengths"
    cells = (pair for row in rows for pair in zip(rows[0], row, strict=False))
    for head, cell in cells:
        number = re.fullmatch(r"-?[\d.]+(e[+-]\d+)?", cell)
        name = head in IDENTITIES and re.fullmatch(r"[\w.@+-]*", cell)  # the platform's own
        if cell[:1] in set("=+-@\t\r") and not number and not name:
            yield f"export: a formula: {cell[:60]!a}"
            break


def seen(course: Path, ended: Ended, name: str = NAME) -> dict[str, Any]:
    """All data about the honest after a command."""
    found: dict[str, Any] = {}
    for path in (course / "results" / name).glob("*.json"):
        data = _result(path)
        if data.get("student") in HONEST:
            left = {"seconds", "isolation", "hashes"}
            found[f"{data['student']}'s result"] = {k: v for k, v in data.items() if k not in left}
    for who in HONEST:
        for place, suffix in (("feedback", "html"), ("autograded", "ipynb")):
            path = course / place / who / name / f"{name}.{suffix}"
            if path.is_file():
                found[f"{who}'s {suffix}"] = path.read_bytes()
    if "export" in ended.words[:2]:
        layout = ended.words[ended.words.index("--layout") + 1]
        for key, rows in rows_of(ended, layout).items():
            found[f"{key}'s row of {layout}"] = rows
    return found


_KEYS = {"questions": 0, "nbgrader": 3, "canvas": 1, "moodle": 3, "moodle-worksheet": 0}
"""The columns that name the student of a row."""
_OURS = {*HONEST, "Participant 101", "7"}


def rows_of(ended: Ended, layout: str) -> dict[str, list[list[str]]]:
    """All rows of each honest student; there should be one."""
    found: dict[str, list[list[str]]] = {}
    for row in csv.reader(io.StringIO(ended.out.decode("utf-8", "replace"), newline="")):
        key = row[_KEYS[layout]] if len(row) > _KEYS[layout] else ""
        key = key or (row[3] if layout == "canvas" and len(row) > 3 else "")
        if key in _OURS:
            found.setdefault(key, []).append(row)
    return found


def _result(path: Path) -> dict[str, Any]:
    try:
        data = json.loads(path.read_text("utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}
    return data if isinstance(data, dict) else {}


def changed(clean: Mapping[str, Any], now: Mapping[str, Any]) -> Iterator[str]:
    """The differences from a class of only the honest."""
    for key, value in clean.items():
        if key not in now:
            yield f"{key} is missing"
        elif now[key] != value:
            short = f": {now[key]!a:.150}" if "row" in key else ""
            yield f"{key} is not what it is among the honest{short}"


def made_up(clean: Mapping[str, Any], now: Mapping[str, Any]) -> Iterator[str]:
    """Rows with a wrong number in a table; an empty cell or a word does not count."""
    for key, rows in now.items():
        right = clean.get(key, rows)
        if "'s row of " in key and any(
            len(rows) != 1 or (a != b and re.fullmatch(r"-?[\d.]+", b))
            for a, b in zip(right[0], rows[0], strict=False)
        ):
            yield f"{key} is made up: {rows!a:.150}"


def results(course: Path, name: str = NAME) -> dict[str, dict[str, Any]]:
    """All results, by student."""
    found = map(_result, (course / "results" / name).glob("*.json"))
    return {data["student"]: data for data in found if "student" in data}
