"""What notebook 01 lets students predict."""

from labkit.course import Choose, Number, Prediction

PREDICTIONS = (
    Prediction(
        "peak_acceleration",
        "The quintic schedule is a polynomial of fifth order whose acceleration is zero at "
        "both ends. Bang-bang jumps from one acceleration to the other. Both cover the same "
        "distance in the same time. Which of them has the higher peak of acceleration?",
        Choose({"a": "bang-bang", "b": "the quintic", "c": "both the same"}),
        truth="b",
    ),
    Prediction(
        "twice_the_time",
        "The circle will take twice as long as before. By what factor does the tip's largest "
        "acceleration change?",
        Number("times", 0.0, 4.0),
        truth=0.25,
    ),
)
