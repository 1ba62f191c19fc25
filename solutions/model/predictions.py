"""What notebook 02 lets students predict."""

from labkit.course import Choose, Prediction, Rank

PREDICTIONS = (
    Prediction(
        "heaviest_direction",
        "You tap the resting arm's tip along x (forwards), y (sideways) and z (upwards). In "
        "which direction does the tip feel heaviest? The arm rests in its ready pose. Its motors "
        "compensate its weight and do nothing else.",
        Rank({"x": "forwards", "y": "sideways", "z": "upwards"}, "the heaviest"),
        truth="zyx",
    ),
    Prediction(
        "base_joint",
        "The first joint, s0, carries the whole arm. Compared with the elbow e1, which carries a third "
        "of it, how much torque does s0 need to hold the arm still?",
        Choose({"a": "more than the elbow", "b": "about as much", "c": "none"}),
        truth="c",
    ),
)
