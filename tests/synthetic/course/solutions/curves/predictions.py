"""What students predict in the course that the grader's tests run on."""

from labkit.course import Number, Prediction

PREDICTIONS = (
    Prediction(
        "twice_the_time",
        "By what factor does the acceleration change if a motion takes twice as long?",
        Number("times", 0.0, 4.0),
        truth=0.25,
        points=13.0,
    ),
)
