"""The number of wrong answers whose mistake the checks name, for answers unknown to the checks.

`build/names.tsv` lists each wrong answer with its author's sentence and the message to the
student, so that a person can judge whether the message fits.
"""

import linecache
import re
from collections import Counter
from pathlib import Path

from labkit.course import student
from labkit.course.messages import message
from labkit.course.verdict import Kind, Outcome
from tests.answers import TOPICS, read

ROOT = Path(__file__).parents[2]
OUT = ROOT / "build/names.tsv"
BEFORE = "import control\nimport cv2\nimport numpy as np\nimport labkit as lk\nfrom math import *\n"


def desks():
    """The desks of all notebooks, by topic."""
    files = sorted((ROOT / "assignments").glob("*/checks.json"))
    return {file.parent.name.partition("_")[2]: student.Desk.beside(file.parent) for file in files}


def function_of(question, source):
    """The function that a cell's text defines after the imports of a notebook."""
    file = f"<{question} {abs(hash(source))}>"
    linecache.cache[file] = (len(source), None, source.splitlines(True), file)
    cell = {}
    exec(BEFORE, cell)
    exec(compile(source, file, "exec"), cell)
    return cell[question]


def told(desk, answer):
    """The verdict of the real check on an answer, and the text for the student."""
    try:
        function = function_of(answer.question, answer.source)
    except Exception as error:
        return None, f"the cell stops: {type(error).__name__}: {error}"
    verdict, printed, _ = desk.verdict(answer.question, function)
    return verdict, str(message(desk.question(answer.question), verdict, printed))


FORM = (Kind.TYPE, Kind.PARTS, Kind.KEY, Kind.NOTHING, Kind.CHANGED, Kind.REFUSED)
"""Differences whose sentence says what is wrong: wrong type or shape, no result, NaN."""
FACTOR = re.compile("is [-0-9.e+]+ times what")
"""A sentence that says by which factor an answer is wrong, but not why, does not name a mistake."""
NAMED = ("known", "observed", "form")


def name_of(verdict):
    """How a verdict names the mistake, and the sentence; "numbers" if it shows only numbers."""
    if verdict.mistake is not None:
        known = verdict.mistake.name
        how = "known" if known else "factor" if FACTOR.search(verdict.mistake.says) else "observed"
        return how, f"{known}: {verdict.mistake.says}".strip(": ")
    for test in verdict.tests:
        if test.difference is not None:
            kind = test.difference.kind
            if kind in FORM or kind is Kind.RAISED:
                how = "form" if kind in FORM else "raised"
                return how, str(test.difference.found or kind)
    return "numbers", ""


def measure():
    """Numbers of wrong answers, of those that are named, and of those that pass."""
    found, counts, lines = desks(), Counter(), []
    for answer in (one for topic in TOPICS for one in read(topic)):
        verdict, text = told(found[answer.topic], answer)
        right = verdict is not None and verdict.outcome is Outcome.RIGHT
        how, name = name_of(verdict) if verdict else ("raised", text)
        how = "accepted" if right else how
        counts[how] += 1
        row = (f"{answer.topic}/{answer.question}", answer.says, how, name, text)
        lines.append("\t".join(" ".join(x.split()) for x in row))
    OUT.parent.mkdir(exist_ok=True)
    OUT.write_text("\n".join(["question\tauthor says\thow\tname\ttext", *lines]) + "\n", "utf-8")
    named = sum(counts[how] for how in NAMED)
    return {
        "named_share": named / counts.total(),
        "known_share": counts["known"] / counts.total(),
        "wrong_answers": counts.total(),
        "accepted_wrong": counts["accepted"],
    }
