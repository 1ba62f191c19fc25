"""Withheld names: found however they are imported, and never where they are not."""

import numpy as np
import pytest

import labkit as lk
from labkit import se3
from labkit.check.source import withheld_names

WITHHELD = ("labkit.Circle", "labkit.Model.gravity", "labkit.se3.inverse", "pinocchio")


def by_attribute(s):
    return lk.Circle([1, 0, 0], [0, 0, 0])(s)


def by_import(s):
    from labkit import Circle

    return Circle([1, 0, 0], [0, 0, 0])(s)


def by_another_name(s):
    from labkit.paths import Circle as Ring

    return Ring([1, 0, 0], [0, 0, 0])(s)


def by_method(model, q):
    return model.gravity(q)


def by_module(T):
    return se3.inverse(T)


def helper(T):
    return se3.inverse(T)


def through_a_helper(T):
    return helper(T)


def a_whole_package(q):
    import pinocchio as pin

    return pin.rnea(q)


def innocent(s):
    gravity = 9.81
    circle = np.array([np.cos(s), np.sin(s)])  # no Circle here, only its name in a comment
    return "labkit.Circle", circle * gravity


@pytest.mark.parametrize(
    ("function", "found"),
    [
        (by_attribute, ["labkit.Circle"]),
        (by_import, ["labkit.Circle"]),
        (by_another_name, ["labkit.Circle"]),
        (by_method, ["labkit.Model.gravity"]),
        (by_module, ["labkit.se3.inverse"]),
        (through_a_helper, ["labkit.se3.inverse"]),
        (a_whole_package, ["pinocchio"]),
        (innocent, []),
        (len, []),
        (eval("lambda s: lk.Circle(s)"), []),  # its source cannot be read
    ],
)
def test_names_are_found(function, found):
    """Each way to lean on a withheld name is seen; a comment, a text or a like name is not."""
    assert withheld_names(function, WITHHELD) == found


def test_recursion_ends():
    """A function that calls itself is read once."""

    def f(n):
        return f(n - 1) if n else lk.Circle

    assert withheld_names(f, WITHHELD) == ["labkit.Circle"]
