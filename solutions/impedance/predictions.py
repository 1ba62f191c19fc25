"""What notebook 05 lets students predict."""

from labkit.course import Identification, Measured, Number, Prediction

PREDICTIONS = (
    Prediction(
        "wall_force",
        "The target is 3 cm behind the surface of a wall. The position mode would press with all "
        "the force that its motors have. With springs of 300 N/m at the tip, and 3,333 N/m of the "
        "wall and the finger's tip together, how hard does the tip press?",
        Number("N", 0.0, 100.0),
        truth=8.3,
    ),
    Identification(
        "my_payload",
        "Your arm carries its own weight, but somebody has left something in its gripper. How "
        "heavy is that object? The arm's joints have dry friction, so a single pose tells you "
        "little.",
        Measured("payload", "kg", 0.0, 3.0, 0.07),
        truth=0.334,
        form="one number, in kg",
        points=3.0,
        hints=(
            "At rest the torque that you must command is that of the load, J^T times the load's "
            "weight, plus friction. Which of the two changes its sign when you come from the "
            "other side?",
            "Let s1 and e1 swing slowly about the ready pose with springs at the joints "
            "(`lk.control.springs`), and average the commanded torque over whole swings. Swing them "
            "by at most 0.12 rad and in opposite directions, so that one moves the tip forwards "
            "while the other moves it back: if both move it forwards, it may press against the "
            "wall, and your average then contains the wall's force.",
            "Compare the averages of s1 and e1 with J^T (0, 0, 9.81), for one kilogram, by least "
            "squares. Take J where the arm really swings, at the mean of `log.q`: the springs give "
            "way under the load, and with the levers of the ready pose s1 and e1 disagree. A second "
            "of averaging is not enough; take several swings.",
        ),
    ),
)
