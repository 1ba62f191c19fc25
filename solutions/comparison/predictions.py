"""What notebook 07 lets students predict."""

from labkit.course import Choose, Number, Prediction

PREDICTIONS = (
    Prediction(
        "thirty_percent_more",
        "On the line the error falls with every increase of Kp up to a best gain. Take that best gain "
        "and raise it by 30 %. The worst error of five seeds becomes how many times the best one?",
        Number("times", 0.1, 1000.0),
        truth=3.0,
    ),
    Prediction(
        "twenty_pairs",
        "Four tasks with five seeds each are 20 differences between two controllers. You want to "
        "speak about tasks in general. Beside the interval from the 4 means of the tasks, the "
        "interval from the 20 differences is",
        Choose({"a": "about as wide", "b": "much narrower", "c": "much wider"}),
        truth="b",
    ),
)
