"""What notebook 03 lets students predict."""

from labkit.course import Curve, Number, Prediction

PREDICTIONS = (
    Prediction(
        "with_more_d",
        "A joint is let go 0.2 rad from its target, which stands still. With kp = 3 and kd = 0 the "
        "error dies away as exp(-3 t): 0.2, 0.08, 0.03, 0.01, ... rad. Draw it for kp = 3 and kd = 3.",
        Curve((0.0, 0.3, 0.6, 0.9, 1.2, 1.5), "time [s]", "error [rad]", -0.2, 0.3),
        truth=[0.2, 0.17, 0.13, 0.1, 0.08, 0.07],
    ),
    Prediction(
        "worst_elbow",
        "The elbow stretches from 0.8 rad to 0 while the tip must move at 10 cm/s in its hardest "
        "direction. At which angle of the elbow do the joints turn fastest, without damping?",
        Number("rad", 0.0, 0.8),
        truth=0.15,
    ),
)
