"""What notebook 00 lets students predict."""

from labkit.course import Choose, Prediction

PREDICTIONS = (
    Prediction(
        "same_components",
        "The gripper points straight down, and its x axis is parallel to the world's. You write "
        "the vector of its orientation error once in world axes and once in the tool's axes. "
        "Which of the three components are the same in both?",
        Choose({"a": "all three", "b": "x alone", "c": "z alone", "d": "none"}),
        truth="b",
    ),
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
