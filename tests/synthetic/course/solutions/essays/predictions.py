"""What students find out about their own arm, beside texts."""

from labkit.course import Identification, Measured

PREDICTIONS = (
    Identification(
        "my_payload",
        "What does your arm carry?",
        Measured("payload", "kg", 0.0, 3.0, 0.07),
        truth=0.334,
        form="one number, in kg",
        points=3.0,
    ),
)
