"""What notebook 06 lets students predict."""

from labkit.course import Choose, Number, Prediction

PREDICTIONS = (
    Prediction(
        "twice_as_far",
        "The tag is moved to twice the distance from the camera. The spread of its measured depth "
        "(along the view) becomes how many times what it was?",
        Number("times", 0.1, 20.0),
        truth=4.0,
    ),
    Prediction(
        "round_and_round",
        "A tag goes round a circle once in six seconds. Its picture is two seconds old. A predictor "
        "carries place and velocity two seconds forward, in a straight line. Compared with taking the "
        "old place for now, the error is then",
        Choose({"a": "about a tenth", "b": "about a half", "c": "larger"}),
        truth="c",
    ),
)
