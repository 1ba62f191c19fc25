"""What notebook 08 lets students predict: nothing that a machine marks."""

from labkit.course import Prediction

PREDICTIONS: tuple[Prediction, ...] = ()
