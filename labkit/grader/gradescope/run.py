"""Gradescope: what runs in its container for each submission; `setup_zip` brings it there.

The container cannot make namespaces, so submissions are isolated by user id; see
`sandbox.isolation.ByUser`.  The manual at gradescope-autograders.readthedocs.io describes the files
under "Autograder Specifications" and "Submission Metadata", and under "Troubleshooting" the limits:
half a processor, 768 MB and 10 minutes, after which nothing counts.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Mapping
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path
from typing import Any

from ...course.authoring.bundle import Bundle
from ...course.authoring.layout import Course
from ...course.messages import summary
from ...course.verdict import Verdict
from ..atomic import write
from ..clean import clean_line
from ..grading.grade import grade, rejection
from ..grading.plan import imports
from ..grading.results import Result
from ..sandbox.launch import Sandbox
from ..sandbox.limits import Limits
from ..sandbox.mounts import Isolation
from ..submission import Submission

PLACE = "LABKIT_AUTOGRADER"
"""The variable with which a test replaces the folder ``/autograder``."""
SECONDS = 540.0
"""After so long the watchdog ends grading, a minute before Gradescope would."""
LIMITS = replace(Limits().scaled(2.5), memory=384)
"""What a submission may use on half a processor and in 768 MB."""
BY_HAND = "A person marks this answer; its points are not among those of the autograder."


def main() -> None:
    """Report at once, grade in another process, and stop that process if it takes too long."""
    place = Path(os.environ.get(PLACE, "/autograder"))
    if "--try" in sys.argv:
        with Sandbox(isolation=Isolation.USER) as sandbox, sandbox.spawn("student", LIMITS):
            print(sandbox.level)
        return
    os.chmod(place, 0o700)
    source = Course(place / "source")
    (path,) = source.bundle.glob("*.json")
    bundle, results = Bundle.of(source, path.stem), place / "results" / "results.json"
    write(results, json.dumps(gradescope_results(bundle, {}, says="It is not graded yet.")))
    grader = get_context("fork").Process(target=_grade, args=(bundle, place, results))
    grader.start()
    grader.join(SECONDS)
    if grader.exitcode == 0:
        return
    why = "it took too long" if grader.is_alive() else "perhaps memory ran out"
    grader.kill()
    found = json.loads(results.read_text())
    says = f"Grading did not finish: {why}. What was graded until then counts."
    write(results, json.dumps(found | {"output": says}))
    print(says)


def _grade(bundle: Bundle, place: Path, results: Path) -> None:
    """Grade what was handed in, and report after each question."""
    student, says = _student(place / "submission_metadata.json", bundle)
    submission = Submission(student, bundle.data["assignment"], place / "submission")
    data, note, why = submission.read()
    verdicts: dict[str, Verdict] = {}

    def reached(verdict: Verdict) -> None:
        verdicts[verdict.name] = verdict
        write(
            results,
            json.dumps(gradescope_results(bundle, verdicts, says="It is still being graded.")),
        )

    with Sandbox(imports(bundle.data["cells"]), isolation=Isolation.USER) as sandbox:
        if why:
            result = rejection(why, student, bundle, sandbox.level)
        else:
            result = grade(data, student, bundle, sandbox, LIMITS, note, reached)
    verdicts = {answer.verdict.name: answer.verdict for answer in result.questions}
    write(results, json.dumps(gradescope_results(bundle, verdicts, result, says)))
    print(result, result.isolation, sep="\n")


def _student(path: Path, bundle: Bundle) -> tuple[str, str]:
    """The address of the student who handed in, and a remark if it is not known."""
    users = json.loads(path.read_text()).get("users", []) if path.exists() else []
    mails = [clean_line(str(user.get("email", ""))).casefold() for user in users] or [""]
    known = [mail for mail in mails if mail in bundle.arms.handles]
    unknown = (
        f"The course's list has no address {mails[0]}, so answers about your own arm were "
        'judged by the public arm "demo"; tell your instructor.'
    )
    return (known or mails)[0], unknown if bundle.arms.handles and not known else ""


def gradescope_results(
    bundle: Bundle, verdicts: Mapping[str, Verdict], result: Result | None = None, says: str = ""
) -> dict[str, Any]:
    """What Gradescope reads: points and words for each question, then what a person marks.

    Args:
        bundle: What was asked.
        verdicts: The verdicts reached so far.
        result: The whole result, once grading has ended.
        says: A remark on the whole submission.
    """
    notes = {x.verdict.name: x.notes for x in result.questions} if result else {}
    written = result.written if result else {}
    tests: list[dict[str, Any]] = []
    for question in bundle.questions:
        verdict, name = verdicts.get(question.name), question.name
        lines = summary(verdict) if verdict else [f"{name}: not graded{'' if result else ' yet'}."]
        lines += [f"Note: {note}." for note in notes.get(name, ())]
        tests.append(
            {"name": name, "score": verdict.earned if verdict else 0.0}
            | {"max_score": question.points, "output": "\n".join(lines), "visibility": "visible"}
        )
    for cell in (m for m in bundle.data["cells"] if "points" in m):
        said = "\n\n".join(filter(None, [BY_HAND, written.get(cell["grade_id"])]))
        tests.append({"name": cell["grade_id"], "output": said, "visibility": "visible"})
    lines = [says]
    if result:
        lines += [f"It could not be graded: {result.rejected}."] if result.rejected else []
        lines += [f"Note: {note}." for note in result.notes]
        lines += [f"Cell {x['cell'] + 1} failed: {x['error']}" for x in result.cells]
        look = f"Isolated by: {result.isolation}"
        tests.append({"name": "for the instructor", "output": look, "visibility": "hidden"})
    score = round(sum(verdict.earned for verdict in verdicts.values()), 2)
    return {"score": score, "output": "\n".join(filter(None, lines)), "tests": tests}


if __name__ == "__main__":
    main()
