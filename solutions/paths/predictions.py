"""What notebook 01 lets students predict."""

from labkit.course import Number, Prediction

PREDICTIONS = (
    Prediction(
        "twice_the_time",
        "The circle will take twice as long as before. By what factor does the tip's largest "
        "acceleration change?",
        Number("times", 0.0, 4.0),
        truth=0.25,
    ),
)
