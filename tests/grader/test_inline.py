"""A function of the course as text: it gives what the function gives, and needs nobody else."""

from pathlib import Path

import numpy as np
import pytest

import labkit as lk
from labkit.course.authoring.layout import Course
from tests.synthetic.inline import inline

COURSE = Course.here(Path(__file__))


def test_a_parameter_keeps_its_name_though_a_question_has_it_too():
    """`coriolis` is given a function that is called as another answer of its module."""
    from solutions.model.answers import coriolis

    names = {}
    exec(inline(coriolis, "coriolis"), names)
    model, q = lk.Model("left"), lk.robot("left").ready
    dq = np.linspace(-0.5, 0.5, 7)
    expected = coriolis(model.mass_matrix, q, dq)
    assert np.array_equal(names["coriolis"](model.mass_matrix, q, dq), expected)


@pytest.mark.parametrize("name", COURSE.names())
def test_every_answer_stands_alone(name):
    """As text, answers, variants and mistakes are as right or wrong as in their modules."""
    from labkit.course.marking import mark

    for problem in COURSE.problems(name):
        question = problem.question(1).public()
        functions = [problem.answer, *problem.variants, *(w.function for w in problem.wrong)]
        for function in functions[:2] + functions[-2:]:
            names = {}
            exec(inline(function, problem.name), names)
            told = mark(question, names[problem.name])
            assert told.outcome == mark(question, function).outcome, (problem.name, function)
