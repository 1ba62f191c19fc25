"""What notebook 04 lets students predict."""

from labkit.course import Found, Identification, Number, Prediction

RUN = (
    "Your {} misbehaving run: which mistake is in the law, and at what time does it first show? "
    "Write the letter and the time in s."
)
INTERVAL = (
    "Plot the error of each joint. At first it is smooth and small; at some time between 0.3 and "
    "1.0 s it no longer is.",
    "What kind of error is it? Does it affect all joints or one, follow gravity or the speed, "
    "grow by itself, or appear only while the target accelerates?",
    "Run the suspects yourself, your own law with one mistake in it, and compare.",
)

PREDICTIONS = (
    Prediction(
        "unknown_load",
        "Somebody puts 0.5 kg into the gripper, and the model does not know of it. Computed "
        "torque with kp = 40 1/s² holds the arm. How far does the tip sag?",
        Number("mm", 0.0, 1000.0),
        truth=21.0,
    ),
    *(
        Identification(
            f"bug_{k + 1}",
            RUN.format(("first", "second", "third")[k]),
            Found(k),
            truth=truth,
            form='a letter and a time, such as ("b", 1.25)',
            points=1.0,
            hints=INTERVAL,
            outcomes=("experiment", "control"),
        )
        for k, truth in enumerate((("c", 0.76), ("h", 0.55), ("f", 0.85)))
    ),
)
