"""What notebook 05 lets students predict."""

from labkit.course import Number, Prediction

PREDICTIONS = (
    Prediction(
        "wall_force",
        "The target is 3 cm behind the surface of a wall. The position mode would press with all "
        "the force that its motors have. With springs of 300 N/m at the tip, and 3,333 N/m of the "
        "wall and the finger's tip together, how hard does the tip press?",
        Number("N", 0.0, 100.0),
        truth=8.3,
    ),
)
