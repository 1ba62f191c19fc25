"""What notebook 07 lets students predict."""

from labkit.course import Choose, Number, Prediction

PREDICTIONS = (
    Prediction(
        "another_seed",
        "You raise Kp from 34 to 90, with Kd = 0. With seed 1 the error grows from 0.91 mm to "
        "1.18 mm, by 29 %. Seed 0 draws another start and other noise: with it, by what factor "
        "does the error change?",
        Number("times", 0.1, 1000.0),
        truth=8.1,
    ),
    Prediction(
        "twenty_pairs",
        "Four tasks with five seeds each give 20 differences between two controllers. You want to "
        "draw a conclusion about tasks in general. Compared with the 95 % interval from the means "
        "of the 4 tasks, the interval from the 20 differences is",
        Choose({"a": "about as wide", "b": "much narrower", "c": "much wider"}),
        truth="b",
    ),
)
