"""What notebook 04 lets students predict."""

from labkit.course import Choose, Number, Prediction

PREDICTIONS = (
    Prediction(
        "gravity_twice",
        "The arm carries its own weight. Your law does not know, and adds g(q) as well. Springs of "
        "80 N m/rad hold each joint. Where is the tip after 1.5 s?",
        Choose({"a": "where it was", "b": "lower", "c": "higher"}),
        truth="c",
    ),
    Prediction(
        "unknown_load",
        "Somebody puts 0.5 kg into the gripper, and the model does not know. Computed torque with "
        "kp = 40 1/s² holds the arm. How far does the tip sag?",
        Number("mm", 0.0, 1000.0),
        truth=110.0,
    ),
)
