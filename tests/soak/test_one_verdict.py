"""One verdict: what a check says, submit-check repeats and the grader counts."""

from __future__ import annotations

import copy
import json
import shutil
from itertools import takewhile
from pathlib import Path
from pkgutil import resolve_name
from tempfile import TemporaryDirectory

import nbformat
import pytest
from handmade import put, raw

from labkit.course import question_data
from labkit.course.authoring.bundle import Bundle
from labkit.course.authoring.layout import Course
from labkit.course.handin import submit_check
from labkit.course.notebook import manifest, source_notebook, verdict_in
from labkit.grader.grade import grade
from labkit.grader.sandbox.launch import Sandbox
from labkit.grader.sandbox.limits import Limits
from tests.synthetic.inline import inline

COURSE = Course.here(Path(__file__))
BY_NAME = """

def {name}(*args, **kwargs):
    import {module}
    {tool}
    return right_{name}(*args, **kwargs)
"""

FUNCTION = {
    "pinocchio": "pinocchio.rnea",
    "labkit.stability": "labkit.stability.margins",
    "labkit.metrics": "labkit.metrics.summary",
    "labkit.tags.detection": "labkit.tags.detection.tag_pose",
}
"""One of each module that is withheld."""


def answers(problem):
    """A question's answers of every kind, as cells."""
    name = problem.name
    yield "stub", ""
    for kind, k in (("wrong", 0), ("wrong too", -1)):
        yield kind, inline(problem.wrong[k].function, name) if problem.wrong else ""
    yield "right", inline(problem.answer, name)
    yield "by name", "\n".join(_using(problem)) if problem.withheld else ""


def _using(problem):
    """A right answer that also names a tool."""
    tool = FUNCTION.get(problem.withheld[-1], problem.withheld[-1])
    yield inline(problem.answer, f"right_{problem.name}")
    module = getattr(resolve_name(tool), "__module__", tool)
    yield BY_NAME.format(name=problem.name, tool=tool, module=module)


@pytest.fixture(scope="module")
def sandbox():
    with Sandbox() as sandbox:
        yield sandbox


def in_a_kernel(assignment, cells, folder):
    """Run cells beside an assignment's questions; the verdict of each, None where there is none."""
    from nbclient import NotebookClient
    from traitlets.config import Config

    shutil.copy(COURSE.release / assignment / "checks.json", folder)
    notebook = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(c) for c in cells])
    with TemporaryDirectory() as sockets:
        files = {"transport": "ipc", "ip": f"{sockets}/kernel"}
        NotebookClient(
            notebook,
            timeout=600,
            kernel_name="python3",
            resources={"metadata": {"path": str(folder)}},
            config=Config({"KernelManager": files}),
        ).execute()
    return [cell.outputs for cell in notebook.cells]


@pytest.mark.parametrize(
    "assignment",
    [name for name in COURSE.names() if COURSE.problems(name)],  # people mark all of a report
)
def test_three_verdicts_are_one(assignment, sandbox, tmp_path):
    """For a stub, wrong and right answers, and a withheld tool."""
    problems = {p.name: p for p in COURSE.problems(assignment)}
    questions = {name: p.question(1).public() for name, p in problems.items()}
    released = COURSE.release / assignment / f"{assignment}.ipynb"
    blank = json.loads(released.read_text(encoding="utf-8"))
    stubs = {
        cell["metadata"]["nbgrader"]["grade_id"]: "".join(cell["source"])
        for cell in blank["cells"]
        if cell["metadata"]["lab"] == "answer"
    }
    kinds = {name: dict(answers(problem)) for name, problem in problems.items()}
    before = takewhile(lambda c: c["metadata"]["lab"] != "answer", blank["cells"])
    setup = ["".join(c["source"]) for c in before if c["metadata"]["lab"] == "setup"]
    tried = [(kind, name) for kind in next(iter(kinds.values())) for name in problems]
    cells = [
        text
        for kind, name in tried
        for text in (kinds[name][kind] or stubs[name], f'check("{name}", {name})')
    ]
    outputs = in_a_kernel(assignment, [*setup, *cells], tmp_path)[len(setup) + 1 :: 2]
    source = source_notebook(
        COURSE.notebook_source(assignment), questions, COURSE.predictions(assignment)
    )
    data = {"assignment": assignment, "seed": 1, "hash": "", "cells": manifest(source)}
    bundle = Bundle(data | {"questions": [question_data(q) for q in questions.values()]})
    for kind in next(iter(kinds.values())):
        notebook = copy.deepcopy(blank)
        said = {}
        for (of, name), output in zip(tried, outputs, strict=True):
            if of == kind:
                put(notebook, name, kinds[name][kind] or stubs[name])
                said[name] = seen(verdict_in(output[0]))
        file = tmp_path / f"{assignment}.ipynb"
        file.write_bytes(raw(notebook))
        verdicts = submit_check(file).verdicts  # also of predictions, which have no right answer
        repeated = {name: seen(verdicts[name]) for name in said}
        result = grade(raw(notebook), "ada", bundle, sandbox, Limits())
        counted = {q.verdict.name: seen(q.verdict) for q in result.questions}
        assert repeated == said
        assert counted == said
        for name, (outcome, earned, withheld) in said.items():
            of = kinds[name][kind] and kind.split()[0]
            expected = {"": "not attempted", "right": "right", "by": "not counted"}.get(of)
            assert outcome == (expected or outcome), (kind, name)
            assert (outcome == "not counted") == bool(withheld) == (of == "by")
            assert earned == (problems[name].points if of == "right" else earned * (of == "wrong"))


def seen(verdict):
    return verdict.outcome.value, verdict.earned, verdict.withheld
