"""What notebook 03 lets students predict."""

from labkit.course import Curve, Identification, Measured, Prediction

PREDICTIONS = (
    Prediction(
        "with_more_d",
        "A joint starts 0.2 rad from its target, which stands still. The joint moves at exactly "
        "the commanded speed. With kp = 3 and kd = 0 the error decays as exp(-3 t): every 0.3 s "
        "it is 0.2, 0.08, 0.03, 0.01, ... rad. Draw the error for kp = 3 and kd = 3.",
        Curve((0.0, 0.3, 0.6, 0.9, 1.2, 1.5), "time [s]", "error [rad]", -0.2, 0.3),
        truth=[0.2, 0.16, 0.13, 0.1, 0.08, 0.07],
    ),
    Identification(
        "my_lag",
        "How long do the motors of your arm take to follow a commanded speed? Command a step "
        "of the speed, look at the log, and give the time constant of the lag.",
        Measured("lag", "s", 0.0, 0.5, 0.005),
        truth=0.033,
        form="one number, in s",
        points=3.0,
        hints=(
            "A joint that follows with the time constant τ has reached 63 % of a step of its "
            "speed after τ. In steady motion at the speed v, its angle is v τ behind.",
            "`log.q` and `log.dq` contain the true angles and speeds, not those that the "
            "controller measured, so they are not delayed. Let one joint turn at 0.4 rad/s for a "
            "second.",
            "Average t - (q(t) - q(0)) / v over the second half of the run.",
        ),
    ),
)
