"""What notebook 07 lets students predict."""

from labkit.course import Choose, Prediction

PREDICTIONS = (
    Prediction(
        "table_1",
        "Table 1 of the report lists for the workspace impedance P = (0.5, 0.5, 0.5, ...) and D = (45, 15, 27, ...). "
        "Take them as stiffness in N/m and damping in N s/m for x, y and z, and push the tip of 1 kg along x with "
        "5 N for two seconds. The tip",
        Choose({"a": "hardly moves", "b": "creeps away as in honey", "c": "swings about 11 cm"}),
        truth="b",
    ),
    Prediction(
        "forty_pairs",
        "Four tasks with ten seeds each give 40 differences between two controllers. You want to "
        "draw a conclusion about tasks in general. Compared with the 95 % interval from the means "
        "of the 4 tasks, the interval from the 40 differences is",
        Choose({"a": "about as wide", "b": "much narrower", "c": "much wider"}),
        truth="b",
    ),
)
