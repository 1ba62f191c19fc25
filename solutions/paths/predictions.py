"""What notebook 01 lets students predict."""

from labkit.course import Choose, Number, Prediction

PREDICTIONS = (
    Prediction(
        "peak_acceleration",
        "Bang-bang jerks, the quintic is smooth. Both cover the same way in the same time. Which of "
        "them asks for the higher peak of acceleration?",
        Choose({"a": "bang-bang", "b": "the quintic", "c": "both the same"}),
        truth="b",
    ),
    Prediction(
        "twice_the_time",
        "The circle is to take twice as long as before. The tip's largest acceleration becomes how "
        "many times what it was?",
        Number("times", 0.0, 4.0),
        truth=0.25,
    ),
)
