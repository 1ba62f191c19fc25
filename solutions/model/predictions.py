"""What notebook 02 lets students predict."""

from labkit.course import Choose, Prediction

PREDICTIONS = (
    Prediction(
        "base_joint",
        "The first joint, s0, carries the whole arm. Compared with the elbow e1, which carries a third "
        "of it, how much torque does s0 need to hold the arm still?",
        Choose({"a": "more than the elbow", "b": "about as much", "c": "none"}),
        truth="c",
    ),
)
