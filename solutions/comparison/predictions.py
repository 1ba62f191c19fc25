"""What notebook 07 lets students predict."""

from labkit.course import Choose, Prediction

PREDICTIONS = (
    Prediction(
        "twenty_pairs",
        "Four tasks with five seeds each give 20 differences between two controllers. You want to "
        "draw a conclusion about tasks in general. Compared with the 95 % interval from the means "
        "of the 4 tasks, the interval from the 20 differences is",
        Choose({"a": "about as wide", "b": "much narrower", "c": "much wider"}),
        truth="b",
    ),
)
