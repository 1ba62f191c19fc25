"""What notebook 06 lets students predict."""

from labkit.course import Prediction

PREDICTIONS: tuple[Prediction, ...] = ()
