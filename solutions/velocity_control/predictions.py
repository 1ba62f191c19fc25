"""What notebook 03 lets students predict."""

from labkit.course import Curve, Prediction

PREDICTIONS = (
    Prediction(
        "with_more_d",
        "A joint starts 0.2 rad from its target, which stands still. The joint moves at exactly "
        "the commanded speed. With kp = 3 and kd = 0 the error decays as exp(-3 t): every 0.3 s "
        "it is 0.2, 0.08, 0.03, 0.01, ... rad. Give the error for kp = 3 and kd = 3.",
        Curve((0.0, 0.3, 0.6, 0.9, 1.2, 1.5), "time [s]", "error [rad]", -0.2, 0.3),
        truth=[0.2, 0.16, 0.13, 0.1, 0.08, 0.07],
    ),
)
