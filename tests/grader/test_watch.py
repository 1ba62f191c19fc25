"""`labkit grade --watch`: what comes in is graded as it comes."""

from __future__ import annotations

from handmade import hand_in
from made import NAME, notebook_of, result_of

from labkit.grader.grading import batch
from labkit.grader.grading.batch import GradeOptions, watch


def test_each_notebook_is_graded_once_as_it_comes(course, monkeypatch):
    """One that was there and those that come later are graded; so is what is handed in again."""
    tasks = []

    def graded(pool, course, bundle, submissions, options):
        tasks.append([x.student for x in submissions])
        return (result_of(course, x.student, data=x.read(1 << 20)[0]) for x in submissions)

    monkeypatch.setattr(batch, "_graded", graded)
    hand_in(course, NAME, "ada", notebook_of("ada"))
    queue = watch(course, NAME, GradeOptions(), pause=0.01)
    assert next(queue).result.student == "ada"
    hand_in(course, NAME, "bob", notebook_of("bob"))
    assert next(queue).result.student == "bob"
    hand_in(course, NAME, "ada", notebook_of("another of ada"))
    assert next(queue).result.student == "ada"
    queue.close()
    assert [one for one in tasks if one] == [["ada"], ["bob"], ["ada"]]
