"""What students predict, beside texts."""

from labkit.course import Number, Prediction

PREDICTIONS = (Prediction("guess", "What does the arm carry?", Number("kg", 0.0, 3.0), 0.3, 3.0),)
