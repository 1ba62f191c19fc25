"""What notebook 05 lets students predict."""

from labkit.course import Choose, Number, Prediction

PREDICTIONS = (
    Prediction(
        "wall_force",
        "The target lies 3 cm behind a wall. The position mode would press with all that its motors "
        "have. With springs of 300 N/m at the tip, how hard does the tip press?",
        Number("N", 0.0, 100.0),
        truth=8.3,
    ),
    Prediction(
        "four_times_the_mass",
        "A hand pushes with 10 N and keeps pushing. The tip pretends to 5 kg, then to 20 kg; its "
        "springs stay the same. After two seconds, how far away is the heavy tip?",
        Choose(
            {
                "a": "a quarter as far as the light one",
                "b": "half as far",
                "c": "as far",
                "d": "farther",
            }
        ),
        truth="c",
    ),
)
