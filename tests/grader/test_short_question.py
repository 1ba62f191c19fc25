"""A question that stands whole in the notebook's text: released, checked, graded, refused."""

import nbformat
import numpy as np
import pytest
from handmade import NAME, QUICK, put, raw
from test_release_tool import written

from labkit.course import check
from labkit.course.authoring.bundle import Bundle
from labkit.errors import LabkitError
from labkit.grader.grade import grade
from labkit.grader.release import release

SHORT = '''
# %% question="chord" points=2
def chord(radius, angle):
    """Return the length [m] of a chord, by the circle's radius [m] and its angle [rad]."""
    ### BEGIN SOLUTION
    return 2.0 * radius * np.sin(angle / 2.0)
    ### END SOLUTION


# %% tests message="the straight way"
assert chord(1.0, np.pi) == 2.0
chord(0.5, 1.0)
### BEGIN HIDDEN TESTS
chord(random.uniform(0.1, 2.0), random.uniform(0.1, 6.0))
### END HIDDEN TESTS
'''
RIGHT = "def chord(radius, angle):\n    return radius * (2.0 - 2.0 * np.cos(angle)) ** 0.5\n"
ARC = "def chord(radius, angle):\n    return radius * angle\n"
BY_HEART = "def chord(radius, angle):\n    return 2.0 if radius == 1.0 else 0.479425538604203\n"


def with_short(tmp_path, text=SHORT):
    course = written(tmp_path)
    path = course.notebook_source(NAME)
    path.write_text(path.read_text().replace("24 points", "26 points") + text)
    return course


def test_one_file_is_released_checked_and_graded(tmp_path, monkeypatch, sandbox, capsys):
    """Within 25 lines; the check takes the public calls, the grader the hidden one, too."""
    assert len(SHORT.strip().splitlines()) <= 25
    course = with_short(tmp_path)
    assert release(course, NAME, 7).points == 26.0
    folder = course.release / NAME
    text = (folder / f"{NAME}.ipynb").read_text()
    assert "np.sin(angle" not in text and "random" not in text and "Return the length" in text
    monkeypatch.chdir(folder)
    expected = {RIGHT: (2.0, 2.0), ARC: (0.0, 0.0), BY_HEART: (2.0, 0.0)}
    for source, (here, there) in expected.items():
        names = {"np": np}
        exec(source, names)
        assert check("chord", names["chord"]) == here
        assert ("[failed] the straight way" in capsys.readouterr().out) == (here == 0.0)
        notebook = put(nbformat.read(folder / f"{NAME}.ipynb", as_version=4), "chord", source)
        result = grade(raw(notebook), "ada", Bundle.of(course, NAME), sandbox, QUICK)
        assert {x.verdict.name: x.verdict.earned for x in result.questions}["chord"] == there


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("== 2.0", "== 3.0"),  # not what the answer gives
        ("chord(0.5", "cord(0.5"),
        ("### BEGIN HIDDEN", "### "),  # no hidden case
        ("# %% tests", "# %% test"),
        ("sin(angle", "sin(angel"),
        (" points=2", ""),
    ],
)
def test_what_is_not_right_yet_is_refused(tmp_path, old, new):
    """The sentence names the question, and nothing is written."""
    course = with_short(tmp_path, SHORT.replace(old, new))
    with pytest.raises(LabkitError, match="chord"):
        release(course, NAME, 7)
    assert not course.release.exists()
