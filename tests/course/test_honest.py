"""Nobody honest is refused: in no answer that the course knows a withheld tool is found."""

import json
from pathlib import Path

import pytest

from labkit.course.authoring.layout import Course
from labkit.course.authoring.release import inlined
from labkit.course.source import analyse, withheld_tools
from tests.synthetic.inline import inline

COURSE = Course.here(Path(__file__))


@pytest.mark.parametrize("assignment", COURSE.names())
def test_no_answer_of_the_course_is_suspected(assignment):
    """Neither the notebooks, nor the answers, the right variants and the known mistakes."""
    file = COURSE.release / assignment / f"{assignment}.ipynb"
    cells = json.loads(file.read_text(encoding="utf-8"))["cells"]
    walk = ["".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"]
    problems = COURSE.problems(assignment)
    solved = [*map(analyse, (*walk, *map(inlined, problems)))]
    for problem in problems:
        assert withheld_tools(solved, problem.name, problem.withheld) == ()
        known = [problem.answer, *problem.variants, *(w.function for w in problem.wrong)]
        for text in (inlined(problem), *(inline(f, problem.name) for f in known)):
            cells = [*solved, analyse(text)]
            assert withheld_tools(cells, problem.name, problem.withheld) == (), text
