"""What notebook 08 lets students commit to: the levels of the two exemplars, before they see ours."""

from labkit.course import Curve, Prediction


def _levels(name: str, which: str, ours: list[float]) -> Prediction:
    return Prediction(
        name,
        f"Mark exemplar {which} with the rubric of the six sections below, before you see how we mark it. "
        "Which level, 0 to 3, does it earn in each row, from 1 (claim and prediction) to 6 (writing and "
        "shares)?",
        Curve((1.0, 2.0, 3.0, 4.0, 5.0, 6.0), "row of the rubric", "level", 0.0, 3.0),
        truth=ours,
    )


PREDICTIONS = (
    _levels("exemplar_one", "one", [1, 1, 1, 0, 1, 1]),
    _levels("exemplar_two", "two", [3, 3, 3, 3, 2, 3]),
)
