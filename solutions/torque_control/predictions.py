"""What notebook 04 lets students predict."""

from labkit.course import Choose, Found, Identification, Number, Prediction, Telling

RUN = (
    "Your {} misbehaving run: which mistake is in the law, and at what time does it first show? "
    "Write the letter and the time in s."
)
INTERVAL = (
    "Plot the error of each joint. At first it is smooth and small; at some time between 0.3 and "
    "1.0 s it no longer is.",
    "What kind of error is it? Does it affect all joints or one, follow gravity or the speed, "
    "grow by itself, or appear only while the target accelerates?",
    "Run the suspects yourself, with `labkit.course.bugs.tells_apart`, and compare.",
)

PREDICTIONS = (
    Prediction(
        "gravity_twice",
        "The arm carries its own weight. Your law does not know this, and adds g(q) as well. "
        "Springs of 80 N m/rad hold each joint. Where is the tip after 1.5 s?",
        Choose({"a": "where it was", "b": "lower", "c": "higher"}),
        truth="c",
    ),
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
    Identification(
        "experiment",
        "Design an experiment that separates the cause of your first run from the suspect that you find "
        "next most likely. Give two letters, the cause first; `start`, how far from its target each joint "
        "begins; and `move`, how far from the ready pose each joint goes, in 1.2 s, before it comes back in "
        "the same time. Both are seven numbers in rad. The check runs the two wrong laws on your experiment. "
        "You earn the points if the joint angles of these two runs differ (RMS) by at least five times as "
        "much as those of two runs of the right law that differ only in their noise.",
        Telling(0),
        truth=("cb", [0.0] * 7, [0.3, 0.2, 0.0, -0.3, 0.2, 0.2, 0.4]),
        form='suspects, start and move, such as ("ad", [0, 0, 0, 0, 0, 0, 0], [0.3, 0, 0, 0, 0, 0, 0])',
        points=2.0,
        core=False,
        outcomes=("experiment", "control"),
    ),
)
