"""The defence: three of a student's own accepted functions, each with a mistake put into it.

The questions are drawn under the term's key, so each student has their own, which stay the same
when the page is printed again.  A mistake is used only if the question's checks reject the function
with it; if the question runs an arm, the arm must miss a limit.

Functions are shown as Python writes them out, without docstrings and comments; so neither the
spacing nor a comment tells which line was changed.
"""

from __future__ import annotations

import ast
import shlex
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from copy import deepcopy
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice, permutations
from pathlib import Path
from typing import Any

from ..course.authoring.bundle import Bundle
from ..course.authoring.layout import DEFENCE, Course
from ..course.marking import try_public
from ..course.question import Call, Loop, Question, Tuned
from ..course.source import parsed
from ..course.verdict import Outcome
from ..errors import LabkitError
from . import evidence
from .clean import few
from .each import Failure
from .feedback import error_over_time, farthest, measures
from .files import write
from .gradebook import open_gradebook
from .marks import current_results
from .pages import file, render_page
from .plan import imports, plan
from .results import Answer, Numbers, Run
from .roster import read_roster
from .rules import read_rules
from .sandbox.launch import Isolation, Sandbox
from .sandbox.limits import Limits, slowness
from .sandbox.session import RemoteFunction, Session
from .seeds import key_of, rank
from .submission import Submission, is_name
from .worker import in_sandbox

ASKED = 3
"""The number of questions in one defence."""
TRIES = 3
"""The number of mistakes that are tried in a function."""
RUBRIC = (
    "says which line was changed, and what it was before",
    "says what the arm will do, or what is returned, before the answer is shown",
    "explains the picture by the line: which term, which sign, which frame",
)
"""The criteria for each question, at one point each."""
FULL = len(RUBRIC)
"""The full marks for each question."""
LINES = tuple(f"question_{k + 1}" for k in range(ASKED))
"""The names of the questions in the gradebook."""
MOST = 300
"""The most mistakes that are tried in one cell; real functions have fewer."""


@dataclass(frozen=True)
class Edit:
    """A cell with a mistake in one line of its functions.

    Attributes:
        cell: The cell with the mistake.
        lines: The lines of its functions, with the mistake.
        at: The number of the line with the mistake, from 1.
        was: The same line without the mistake.
        says: The mistake in a few words.
    """

    cell: str
    lines: tuple[str, ...]
    at: int
    was: str
    says: str

    @property
    def now(self) -> str:
        """The line with the mistake."""
        return self.lines[self.at - 1]


@dataclass(frozen=True)
class Accepted:
    """An answer that earned full marks.

    Attributes:
        bundle: The bundle of its assignment, for this student.
        question: The question.
        answer: The answer with its verdict.
        right: The names of all questions in this notebook that earned full marks.
        how: What isolated the answer when it was graded.
    """

    bundle: Bundle
    question: Question
    answer: Answer
    right: tuple[str, ...]
    how: Isolation

    @property
    def assignment(self) -> str:
        """The name of its assignment."""
        return str(self.bundle.data["assignment"])

    @property
    def drives(self) -> bool:
        """Whether the question runs an arm with the answer."""
        return any(isinstance(c, Loop | Tuned) for t in self.question.tests for c in t.cases)


@dataclass(frozen=True)
class Asked:
    """One question of a defence.

    Attributes:
        of: The answer that the question is about.
        edit: The mistake, and the functions with it.
        run: The run of the arm with the mistake, if the question has one.
        numbers: Otherwise, the numbers returned with the mistake and those expected.
    """

    of: Accepted
    edit: Edit
    run: Run | None
    numbers: Numbers | None

    @property
    def given(self) -> str:
        """The arguments of the law in its run besides state and target, such as "(kp=40.0)"."""
        tests = [t for t in self.of.question.tests if self.run and t.name == self.run["test"]]
        loops = [case for test in tests for case in test.cases if isinstance(case, Loop)]
        return Call((), loops[0].kwargs).shown("") if loops and loops[0].kwargs else ""


def draw(course: Course, student: str) -> tuple[Asked, ...]:
    """The questions of a student's defence; fewer where fewer answers can be asked about.

    Raises:
        LabkitError: There is no such student, nothing was handed in, or work is not graded.
        NoIsolation: No sandbox can be made here.
    """
    secret = partial(rank, key_of(course, "defence"), student)
    answers = list(_accepted(course, student))
    answers.sort(key=lambda x: (not x.drives, secret(x.assignment, x.question.name)))
    if not answers:
        return ()
    limits = Limits().scaled(slowness())

    def drawn(sandbox: Sandbox) -> tuple[Asked, ...]:
        found = (_ask(course, student, one, sandbox, limits, secret) for one in answers)
        return tuple(islice(filter(None, found), ASKED))

    modules = {name: None for one in answers for name in imports(one.bundle.data["cells"])}
    return in_sandbox(drawn, course, tuple(modules), answers[0].how)


def _accepted(course: Course, student: str) -> Iterator[Accepted]:
    """A student's answers that earned full marks, and that a mistake can be put into."""
    _check_known(course, student)
    worked = False
    for name in sorted(path.stem for path in course.bundle.glob("*.json")):
        for result in current_results(course, name, student):
            worked = True
            if isinstance(result, Failure):
                raise LabkitError(f"{name}: {result.why}")
            right = {q.verdict.name: q for q in result.questions if q.verdict.right}
            bundle = Bundle.of(course, name)
            for question in bundle.questions:
                if question.name in right and edits(right[question.name].source):
                    how = Isolation.of(result.isolation)
                    yield Accepted(bundle, question, right[question.name], tuple(right), how)
    if not worked:
        raise LabkitError(f"{student} has handed in nothing, so there is nothing to ask about")


def _check_known(course: Course, student: str) -> None:
    """Raise a LabkitError if nobody has this folder."""
    listed = list(read_roster(course))
    folders = [path.name for path in course.submitted.glob("*") if is_name(path.name)]
    if student not in {*folders, *listed}:
        says = f"there is no student {student!r}; give the name of a folder: {few(folders)}"
        raise LabkitError(says)


def _ask(
    course: Course,
    student: str,
    one: Accepted,
    sandbox: Sandbox,
    limits: Limits,
    secret: Callable[..., bytes],
) -> Asked | None:
    """A question about an answer; None if no mistake that is tried changes what the checks say."""
    data, _, _ = Submission.of(course, one.assignment, student).read()
    cells, question = Session(sandbox, limits).read(data), one.question
    todo = plan(cells, one.bundle.data["cells"])
    place = todo.places[question.name]
    mistakes = edits(todo.source(question.name))
    mistakes.sort(key=lambda edit: secret(question.name, str(edit.at), edit.now))
    for edit in mistakes[:TRIES]:
        steps = [replace(x, source=edit.cell) if x.number == place else x for x in todo.steps]
        with closing(Session(sandbox, limits, steps)) as session:
            session.right = [name for name in one.right if name != question.name]
            tried = try_public(question, RemoteFunction(question, session))
            session.close_question()
        failed = {x.name for x in tried.results if x.outcome in (Outcome.WRONG, Outcome.ERROR)}
        run = next((x for x in evidence.runs(question, tried) if x["test"] in failed), None)
        numbers = None if one.drives else evidence.numbers(question, tried)
        if tried.outcome is Outcome.WRONG and (run or numbers):
            return Asked(one, edit, run, None if run else numbers)
    return None


_PAIRS = ("cos sin", "max min", "maximum minimum", "body_jacobian tip_jacobian")
EXCHANGED = {"acceleration": "velocity"}
"""Names that students confuse, such as the two Jacobians, or sine and cosine."""
EXCHANGED |= {a: b for pair in _PAIRS for a, b in permutations(pair.split())}
_OPPOSITE = ((ast.Add, ast.Sub), (ast.Lt, ast.Gt), (ast.LtE, ast.GtE))
_TURNED: dict[type[ast.AST], type[ast.AST]] = {
    a: b for pair in _OPPOSITE for a, b in permutations(pair)
}


def edits(source: str) -> list[Edit]:
    """All mistakes that fit the functions of a cell, by line; none without Python."""
    found: dict[tuple[int, str], Edit] = {}
    try:
        cell = deepcopy(parsed(source)[1])
        functions = [x for x in cell.body if isinstance(x, ast.FunctionDef)]
        for function in functions:
            if ast.get_docstring(function, clean=False) is not None:
                function.body = function.body[1:] or [ast.Pass()]
        before = _written(functions)
        mistakes = ((*x, *wrong) for x in _places(functions) for wrong in _mistakes(x[0]))
        for node, put, wrong, says in islice(mistakes, MOST):
            put(wrong)
            lines = _written(functions)
            differ = [k for k, line in enumerate(lines) if before[k : k + 1] != [line]]
            if len(differ) == 1 and len(before) == len(lines):
                (k,) = differ
                edit = Edit(ast.unparse(cell), tuple(lines), k + 1, before[k], says)
                found.setdefault((k, lines[k]), edit)
            put(node)
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        return []
    return [found[place] for place in sorted(found)]


def _written(functions: list[ast.FunctionDef]) -> list[str]:
    return [line for function in functions for line in ast.unparse(function).split("\n")]


def _places(functions: list[ast.FunctionDef]) -> Iterator[tuple[ast.AST, Callable[[Any], None]]]:
    """All nodes in the functions' bodies, each with a function that replaces it."""
    waiting: list[ast.AST] = [ast.Module(function.body, []) for function in functions]
    while waiting:
        parent = waiting.pop()
        for name, value in ast.iter_fields(parent):
            there = [(value, partial(setattr, parent, name))]
            if isinstance(value, list):
                there = [(part, partial(value.__setitem__, k)) for k, part in enumerate(value)]
            for node, put in there:
                if isinstance(node, ast.AST):
                    waiting.append(node)
                    yield node, put


def _mistakes(node: ast.AST) -> Iterator[tuple[ast.AST, str]]:
    """The mistakes that fit one node, each as the node that replaces it."""
    match node:
        case ast.UnaryOp(op=ast.USub() | ast.Not()):
            yield node.operand, "a sign, or a not, is left out"
        case ast.BinOp(op=ast.Add() | ast.Sub()) | ast.AugAssign(op=ast.Add() | ast.Sub()):
            yield _with(node, op=_TURNED[type(node.op)]()), "the sign of a term is reversed"
            if isinstance(node, ast.BinOp):
                yield node.left, "a term is left out"
        case ast.BinOp(op=ast.Mult() | ast.MatMult()):
            yield node.right, "a factor is left out"
        case ast.BinOp():
            yield node.left, "a divisor or an exponent is left out"
        case ast.Compare(ops=[op]) if type(op) in _TURNED:
            yield _with(node, ops=[_TURNED[type(op)]()]), "a comparison is reversed"
        case ast.Attribute(attr="T"):
            yield node.value, "a transpose is left out"
        case ast.Attribute(attr=name) | ast.Name(id=name) if name in EXCHANGED:
            field = "id" if isinstance(node, ast.Name) else "attr"
            yield _with(node, **{field: EXCHANGED[name]}), f"{EXCHANGED[name]} stands for {name}"
        case ast.Subscript(slice=ast.Constant(value=int())):
            yield _with(node, slice=ast.Constant(-1)), "the last one is taken (index -1)"
        case ast.Slice(lower=None, upper=ast.Constant(), step=None):
            yield ast.Slice(node.upper), "the other part of a vector is taken"


def _with(node: ast.AST, **fields: Any) -> Any:
    """A node with some fields changed."""
    return type(node)(**(dict(ast.iter_fields(node)) | fields))


def write_page(course: Course, student: str, asked: Sequence[Asked]) -> Path:
    """Write the page of a student, a side for them and one for the examiner; return its file."""
    page = render_page(
        "defence.html.j2",
        file("defence.css"),
        replays=any(one.run and one.run["motion"] for one in asked),
        student=student,
        course=read_rules(course).name,
        asked=asked,
        rubric=RUBRIC,
        full=FULL,
        count=ASKED,
        command=f"labkit defence {shlex.quote(student)} --mark {' '.join(['?'] * ASKED)}",
        error_over_time=error_over_time,
        measures=measures,
        farthest=farthest,
    )
    path = course.build / "defence" / f"{student}.html"
    write(path, page)
    return path


def give_mark(course: Course, student: str, points: Sequence[int]) -> None:
    """Write the points of a defence that was held into the gradebook, a number for each question.

    Raises:
        LabkitError: Nobody is so called.
    """
    _check_known(course, student)
    with open_gradebook(course) as book:
        book.update_or_create_assignment(DEFENCE)
        book.update_or_create_notebook(DEFENCE, DEFENCE)
        for name in LINES:
            about = {"max_score": FULL, "cell_type": "markdown"}
            book.update_or_create_grade_cell(name, DEFENCE, DEFENCE, **about)
        book.update_or_create_student(student)
        submission = book.update_or_create_submission(DEFENCE, student)
        for grade in (x for notebook in submission.notebooks for x in notebook.grades):
            grade.manual_score = float(points[LINES.index(grade.name)])
            grade.needs_manual_grade = False
        book.db.commit()
