"""What notebook 06 lets students predict."""

from labkit.course import Choose, Number, Prediction

PREDICTIONS = (
    Prediction(
        "twice_as_far",
        "The tag is moved to twice the distance from the camera. By what factor does the spread of its "
        "measured depth (along the view) change?",
        Number("times", 0.1, 20.0),
        truth=4.0,
    ),
    Prediction(
        "round_and_round",
        "A tag goes round a circle once in six seconds. Its picture is two seconds old. A "
        "predictor carries the position two seconds forward with the velocity, in a straight "
        "line. Compared with the error of using the old position as if it were current, the "
        "predictor's error is",
        Choose({"a": "about a tenth", "b": "about a half", "c": "larger"}),
        truth="c",
    ),
)
