"""What notebook 00 lets students predict."""

from labkit.course import Choose, Prediction

PREDICTIONS = (
    Prediction(
        "farthest_off",
        "The hand starts 12 degrees from its target orientation. Three controllers turn it for "
        "1.5 seconds, each with a different definition of the error. Which controller leaves the "
        "hand farthest from its target?",
        Choose(
            {
                "a": "one turn, in world axes",
                "b": "roll, pitch and yaw subtracted",
                "c": "one turn, in the tool's axes",
            }
        ),
        truth="c",
    ),
)
