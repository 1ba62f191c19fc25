"""What notebook 04 lets students predict."""

from labkit.course import Number, Prediction

PREDICTIONS = (
    Prediction(
        "unknown_load",
        "Somebody puts 0.5 kg into the gripper, and the model does not know of it. Computed "
        "torque with kp = 40 1/s² holds the arm. How far does the tip sag?",
        Number("mm", 0.0, 1000.0),
        truth=21.0,
    ),
)
