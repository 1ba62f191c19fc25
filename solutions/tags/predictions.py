"""What notebook 06 lets students predict."""

from labkit.course import Choose, Prediction

PREDICTIONS = (
    Prediction(
        "hand_of_then",
        "The tag moves at 3 cm/s and is seen 0.5 s late by the camera in the hand. A servo uses the "
        "pose that the hand has *now* in place of that at the stamp. What does the hand do?",
        Choose({"a": "it lags behind", "b": "it is ahead of the tag", "c": "it runs away"}),
        truth="c",
    ),
)
