"""A student's own work on his page: the run of his arm and the numbers of his answer.

Everything comes from the data that `seen` put into the result; a result without it has none.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from html import escape
from typing import Any

import numpy as np

from ..metrics import SETTLED
from ..replay import recorded_html
from ..replay.motion import unpack
from .drawing import curve, side_by_side
from .results import Answer, Result

MEASURES = {
    "rms_mm": ("position error of the tip, RMS", "mm", 1.0),
    "max_mm": ("position error of the tip, largest", "mm", 1.0),
    "rms_deg": ("orientation error of the tip, RMS", "degrees", 1.0),
    "max_deg": ("orientation error of the tip, largest", "degrees", 1.0),
    "rms_velocity_mm_s": ("velocity error of the tip, RMS", "mm/s", 1.0),
    "settling": (f"until it stays within {1e3 * SETTLED:g} mm", "s", 1.0),
    "effort": ("motor torque, RMS", "N m", 1.0),
    "saturated": ("commands that a limit cut", "%", 100.0),
    "duration": ("duration", "s", 1.0),
}
"""What each field of `metrics.Summary` is called, its unit, and what one is in that unit."""


def has_replay(result: Result) -> bool:
    """Whether a page of this result needs the viewer."""
    return any(run["motion"] for question in result.questions for run in question.runs)


def own_work(question: Answer) -> Iterator[str]:
    """What there is to be seen of a question, as HTML."""
    for run in question.runs:
        yield from _run(run)
    if question.numbers and question.numbers["of"] > 1:  # one stands in the reason
        yield from _numbers(question.numbers)


def _run(run: Mapping[str, Any]) -> Iterator[str]:
    yield f"<h3>Your run: {escape(run['test'])}</h3>"
    ended = "" if run["complete"] else " It ran away; this is what it did up to then."
    yield f"<p>{escape(run['says'][:1].upper() + run['says'][1:])}.{ended}</p>"
    motion = json.loads(run["motion"]) if run["motion"] else None
    if motion is not None:
        yield _error_over_time(motion, run["limits"].get("max_mm"), run["since"])
    if run["measures"]:
        yield from _table(run)
    if motion is not None:
        yield recorded_html(motion, run["words"], "The same run in three dimensions.")


def _error_over_time(motion: Mapping[str, Any], limit: float | None, since: float) -> str:
    error = 1e3 * np.abs(unpack(motion["error"])[:, 0])
    t = motion["start"] + motion["period"] * np.arange(len(error))
    peak = int(error.argmax())
    alt = (
        f"Position error of the tip over {t[-1]:.3g} s: {_plain(error[0])} mm at the start, "
        f"largest at {t[peak]:.3g} s with {_plain(error[peak])} mm, {_plain(error[-1])} mm at the "
        "end."
    )
    line = ""
    if limit is not None:
        from_then = f" from {since:g} s on" if since else ""
        line = f" The dashed line is the largest that is allowed{from_then}, {limit:g} mm."
    picture = curve(t.tolist(), error.tolist(), ("time [s]", "position error [mm]"), alt, limit)
    return f"<figure>{picture}<figcaption>{alt}{line}</figcaption></figure>"


def _table(run: Mapping[str, Any]) -> Iterator[str]:
    when = f"Measured from {run['since']:g} s on" if run["since"] else "Measured over the whole run"
    yield f'<table><caption>{when}</caption><thead><tr><th scope="col">measure</th>'
    yield '<th scope="col">yours</th><th scope="col">at most</th></tr></thead><tbody>'
    for name, value in run["measures"].items():
        words, unit, factor = MEASURES.get(name, (name, "", 1.0))
        limit = run["limits"].get(name)
        over = limit is not None and (value is None or value > limit)
        kind = "" if limit is None else f' class="{"no" if over else "yes"}"'
        most = "" if limit is None else _amount(limit, factor, unit)
        yield f'<tr><th scope="row">{escape(words)}</th>'
        yield f"<td{kind}>{_amount(value, factor, unit)}</td><td>{most}</td></tr>"
    yield "</tbody></table>"


def _amount(value: float | None, factor: float, unit: str) -> str:
    return "never" if value is None else f"{_plain(factor * value)} {escape(unit)}"


def _plain(x: float) -> str:
    """Three digits or more, without an exponent up to a billion."""
    return f"{x:.0f}" if 1e3 <= abs(x) < 1e9 else f"{x:.3g}"


def _numbers(found: Mapping[str, Any]) -> Iterator[str]:
    call, expected, given = escape(found["call"]), found["expected"], found["given"]
    apart = [abs(a - b) for a, b in zip(expected, given, strict=True)]
    worst = max(range(len(apart)), key=apart.__getitem__)
    alt = (
        f"Of {found['of']} numbers, number {worst + 1} is farthest off: expected "
        f"{expected[worst]:.4g}, yours {given[worst]:.4g}."
    )
    some = "" if found["of"] == len(given) else f" The first {len(given)} are shown."
    yield "<h3>Your numbers beside those expected</h3>"
    yield f"<figure><p><code>{call}</code></p>{side_by_side(expected, given, alt)}"
    yield f"<figcaption>{alt}{some} Rings are what was expected, crosses are yours.</figcaption>"
    yield "</figure><details><summary>The numbers</summary>"
    yield f'<div class="long" tabindex="0" role="group" aria-label="Numbers of {call}">'
    yield '<table><thead><tr><th scope="col">number</th><th scope="col">expected</th>'
    yield '<th scope="col">yours</th></tr></thead><tbody>'
    for k, (wanted, came) in enumerate(zip(expected, given, strict=True), start=1):
        yield f'<tr><th scope="row">{k}</th><td>{wanted:.6g}</td><td>{came:.6g}</td></tr>'
    yield "</tbody></table></div></details>"
