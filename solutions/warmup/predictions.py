"""What notebook 00 lets students predict."""

from labkit.course import Choose, Prediction

PREDICTIONS = (
    Prediction(
        "same_components",
        "The gripper points straight down, and its x axis is parallel to the world's. An error of its "
        "orientation is a vector; you write it once in the axes of the world and once in the axes of the tool. Which of the three numbers are "
        "the same in both?",
        Choose({"a": "all three", "b": "x alone", "c": "z alone", "d": "none"}),
        truth="b",
    ),
    Prediction(
        "farthest_off",
        "The hand starts 12 degrees off. Three controllers turn it for 1.5 seconds, each with another "
        "idea of the error. Which hand is farthest off at the end?",
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
