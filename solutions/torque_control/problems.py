"""The questions of notebook 04."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import labkit as lk
from labkit.course import Bug, Call, Close, Gains, Loop, Tuned
from labkit.course.authoring.problem import Problem, Trial, Wrong, call

from . import answers, hidden, mistakes, variants

MODEL = lk.Model("left", lk.BAXTER)
READY = MODEL.robot.ready
TORQUE = Close(rtol=1e-6, atol=1e-6)
KP = np.array([40.0, 40.0, 25.0, 25.0, 8.0, 8.0, 4.0])
KD = np.array([10.0, 10.0, 6.0, 6.0, 2.0, 2.0, 1.0])
OFF = np.array([0.1, -0.1, 0.1, 0.1, -0.1, 0.1, -0.1])
SPEED = np.array([0.8, -0.5, 0.4, 1.0, -1.2, 0.9, 1.5])
WANTED = np.array([0.2, 0.6, -0.7, 0.3, 1.0, -0.4, 0.5])
PUSH = np.array([1.0, 2.0, -1.5, 1.0, 3.0, -2.0, 4.0])
BARE = lk.Plant(name="ideal, with rotors", armature=0.05)


def _law(ddq: float, speed: float, wanted: float, *, compensates: bool) -> Call:
    target = lk.Sample(READY + OFF, wanted * WANTED, ddq * PUSH)
    state = lk.State(0.7, READY, speed * SPEED)
    return call(state, target, MODEL, kp=KP, kd=KD, arm_compensates=compensates)


def _return(kp: float, kd: float, settle: float, most: float) -> Loop:
    """A return from 0.15 rad off in every joint, which needs feedback."""
    model = lk.Model("left", BARE)
    given = {"model": model, "kp": kp, "kd": kd, "arm_compensates": False}
    return Loop(
        lk.Hold(READY, 2.5),
        given,
        plant=BARE,
        q0=READY + 1.5 * OFF,
        settle=settle,
        expected={"max_mm": most},
    )


HINTS_SWITCH = (
    "Either the arm or the law carries the weight, not both: add model.gravity(state.q) only "
    "where arm_compensates is False."
)

TERMS = (
    Trial(
        "who carries the weight",
        (
            _law(0.0, 0.0, 0.0, compensates=False),
            _law(0.0, 0.0, 0.0, compensates=True),
        ),
        hidden.weight,
        "the switch both ways",
    ),
    Trial(
        "a target that speeds up",
        (_law(1.0, 0.0, 0.0, compensates=True),),
        hidden.speeding_up,
    ),
    Trial(
        "an arm and a target at different speeds",
        (_law(0.0, 1.0, 1.0, compensates=True),),
        hidden.moving,
        "an arm quicker or slower than its target",
    ),
    Trial(
        "everything at once",
        (_law(1.0, 1.0, 1.0, compensates=False), _law(1.0, 1.0, 1.0, compensates=True)),
        hidden.all_at_once,
        weight=4.0,
    ),
)
"""Trials for each term of the law, in both of its forms."""

AUGMENTED_PD = Problem(
    name="augmented_pd",
    points=4,
    outcomes=("control",),
    asks="Give the `lk.JointTorque` of the augmented PD law: the torque that the target's motion "
    "takes (M times the target's acceleration, C times the target's speed, and the weight if the "
    "arm does not carry it itself), plus a spring `kp` and a damper `kd` at each joint. Evaluate "
    "M, C and g at the arm's own state, not at the target's.",
    answer=answers.augmented_pd,
    judge=TORQUE,
    trials=(
        Trial(
            "at rest, off the target: the springs alone",
            (_law(0.0, 0.0, 0.0, compensates=True),),
            hidden.at_rest,
            "both arms, any pose",
            weight=0.0,
        ),
        *TERMS,
        Trial(
            "a run back to a place, from 0.15 rad off",
            (_return(60.0, 15.0, 2.0, 8.0),),
            hidden.augmented_runs,
            "a circle, from an offset",
        ),
    ),
    withheld=("labkit.control.springs",),
    hints=(
        "Write the error first, e = target.position - state.q, and its rate in the same way from "
        "the speeds. Then the torque is a sum of four parts: inertia, Coriolis, weight, and the "
        "springs and dampers.",
        HINTS_SWITCH + " M is model.mass_matrix(state.q), C is model.coriolis(state.q, state.dq).",
        "The law has five terms. Two are for the motion, and both use the target's motion. One is "
        "the weight, which is added under a condition. Two are the springs and the dampers, which "
        "M does not multiply.",
    ),
    terms=mistakes.augmented_terms,
    wrong=(
        Wrong(
            "the error reversed",
            "The springs push the arm away from its target. With e as target minus actual, every "
            "gain has a plus.",
            mistakes.actual_minus_target,
            "Choose the sign of e once, and say it aloud.",
        ),
        Wrong(
            "the weight carried twice",
            "The weight is added although the arm carries it already, so the arm would rise. "
            "Where arm_compensates is True, add none.",
            mistakes.always_carries,
            "On Baxter the right factor for gravity is 0.",
        ),
        Wrong(
            "C times the arm's own speed",
            "Multiply C by the target's speed: for this law stability is proven. With the arm's "
            "own speed, as in the report's equation 18, stability takes more damping. At low "
            "speed the difference is hard to see.",
            mistakes.own_speed_in_coriolis,
            "MLS 4.53 has C(q, dq) dq_d, because the proof uses the skew symmetry of dM - 2C.",
        ),
        Wrong(
            "damping of the motion, not of the error",
            "The damper brakes the arm's own speed, so it holds the arm back whenever the target "
            "moves. It should brake the difference: target.velocity - state.dq.",
            mistakes.damps_the_motion,
            "The damper sits between the arm and the target, not between the arm and the wall.",
        ),
        Wrong(
            "the model evaluated at the target",
            "M, C and g are evaluated at the target's angles. The arm's inertia and weight are "
            "those of the pose where the arm is: use state.q.",
            mistakes.model_at_the_target,
            "The physics happens at q, not at q_d.",
        ),
        Wrong(
            "the springs reversed",
            "The error of the angles has the wrong sign, so the springs push the arm away. Take "
            "target minus actual.",
            mistakes.AugmentedLaw(e=-1.0),
            "One sign for every error.",
        ),
        Wrong(
            "the switch reversed",
            "arm_compensates is True where the arm carries its own weight; add g(q) only where it "
            "is False.",
            mistakes.AugmentedLaw(switch=True),
            "Say who carries the weight: the arm or the law.",
        ),
        Wrong(
            "the weight subtracted",
            "g(q) is what the motors must give to hold the arm: add it.",
            mistakes.AugmentedLaw(weight=-1.0),
            "In the equation of motion g is on the left and the motors are on the right.",
        ),
        Wrong(
            "no Coriolis torques",
            "C times the target's speed is missing. Add it, although at low speed its effect is "
            "hard to see.",
            mistakes.AugmentedLaw(coriolis=0.0),
            "A small effect is not zero: try a fast motion.",
        ),
        Wrong(
            "C of the target's speed",
            "C must be evaluated at the arm's own state, C(q, q̇). Only the speed that you "
            "multiply by C is the target's.",
            mistakes.AugmentedLaw(at_target=True),
            "C(q, q̇) q̇_d has two speeds: one inside C, one that C multiplies.",
        ),
        Wrong(
            "no inertia",
            "M times the target's acceleration is missing. Add it.",
            mistakes.AugmentedLaw(beside=0.0, diagonal=0.0),
            "A target that speeds up needs torque.",
        ),
        Wrong(
            "kp and kd swapped",
            "kp multiplies the error of the angles, and kd that of the speeds.",
            mistakes.AugmentedLaw(swapped=True),
            "The units tell which is which: kp is in N m/rad, kd in N m s/rad.",
        ),
        Wrong(
            "springs and dampers inside M",
            "In this law M multiplies only the target's acceleration: kp e and kd ė are torques "
            "already. Keep them outside M.",
            mistakes.TorqueBy(lambda x: x.motion + x.M @ x.pull + x.g),
            "Units: say whether kp e is a torque or an acceleration.",
        ),
        Wrong(
            "the mass matrix where the target is",
            "Evaluate M where the arm is: model.mass_matrix(state.q).",
            mistakes.TorqueBy(
                lambda x: (
                    x.motion
                    + (x.model.mass_matrix(x.target.position) - x.M) @ x.target.acceleration
                    + x.pull
                    + x.g
                )
            ),
            "Evaluate the model at the arm's own angles.",
        ),
    ),
    variants=(variants.augmented_by_newton_euler, variants.augmented_in_a_list),
)

COMPUTED_TORQUE = Problem(
    name="computed_torque",
    points=4,
    outcomes=("control",),
    asks="Give the `lk.JointTorque` of computed torque: the torque that gives the arm the "
    "acceleration with which the error would decay like that of a damped spring. Add the weight "
    "only if the arm does not carry it itself.",
    answer=answers.computed_torque,
    judge=TORQUE,
    trials=(
        Trial(
            "at rest, off the target",
            (_law(0.0, 0.0, 0.0, compensates=True),),
            hidden.at_rest,
            "both arms, any pose",
            weight=0.0,
        ),
        *TERMS,
        Trial(
            "a run back to a place, from 0.15 rad off",
            (_return(100.0, 20.0, 1.2, 0.3),),
            hidden.computed_runs,
            "a circle, from an offset",
        ),
    ),
    hints=(
        "First find an acceleration: if the joints had it, the error would obey ë + kd ė + kp e = "
        "0. Which acceleration is that?",
        "ddq = target.acceleration + kd * de + kp * e. Then the torque for it is that of the "
        "manipulator equation, at the arm's own q and dq. " + HINTS_SWITCH,
        "Put the acceleration that you want into the equation of motion, with the arm's own state "
        "everywhere else. Leave out what the arm does for itself.",
    ),
    wrong=(
        Wrong(
            "the gains outside M",
            "With the gains outside M every joint responds differently, because each has another "
            "inertia. Put kp e and kd ė into the acceleration, before you multiply by M.",
            mistakes.gains_outside,
            "In computed torque kp is in 1/s², so it belongs inside M.",
        ),
        Wrong(
            "the model evaluated at the target",
            "M, C and g are evaluated at the target's angles and speeds. They cancel the arm's "
            "own torques only if they are evaluated where the arm is: use state.q and state.dq.",
            mistakes.everything_at_the_target,
            "What is to cancel must be evaluated at the same place.",
        ),
        Wrong(
            "the inverse of M",
            "M itself turns an acceleration into a torque. Do not invert it.",
            mistakes.ComputedLaw(power=-1),
            "Check the units: N m or rad/s²?",
        ),
        Wrong(
            "kp and kd swapped",
            "kp multiplies the error of the angles, and kd that of the speeds.",
            mistakes.ComputedLaw(swapped=True),
            "The units tell which is which: kp is in 1/s², kd in 1/s.",
        ),
        Wrong(
            "the mass matrix where the target is",
            "Evaluate M where the arm is: model.mass_matrix(state.q).",
            mistakes.TorqueBy(
                lambda x: x.model.mass_matrix(x.target.position) @ x.wish + x.drift + x.g
            ),
            "Evaluate the model at the arm's own angles.",
        ),
        Wrong(
            "only the diagonal of M",
            "The joints accelerate each other, so the numbers off the diagonal of M belong to the "
            "law. Use the whole matrix.",
            mistakes.TorqueBy(lambda x: np.diag(x.M) * x.wish + x.drift + x.g),
            "A mass matrix couples the joints.",
        ),
    ),
    terms=mistakes.computed_terms,
    variants=(variants.computed_by_newton_euler, variants.computed_by_bias),
)


SAMPLED_JOINT = Problem(
    name="sampled_joint",
    points=4,
    outcomes=("control",),
    asks="A joint of some `inertia` has angle q and speed q̇; its torque -kp q - kd q̇ is computed once "
    "every `dt` seconds and held in between. Give the matrix of shape (2, 2) that takes (q, q̇) from one "
    "sample to the next, exactly.",
    answer=answers.sampled_joint,
    judge=Close(rtol=1e-6, atol=1e-9),
    trials=(
        Trial(
            "a joint of 0.5 kg m² at 200 Hz",
            (call(0.5, 50.0, 10.0, 0.005),),
            hidden.joints,
            "heavy and light joints",
            weight=0.0,
        ),
        Trial(
            "a wrist without its rotor: 0.001 kg m²",
            (call(0.001, 1.0, 0.2, 0.005), call(0.001, 1.0, 0.2, 0.001)),
            hidden.slow_samples,
            "rates that are too slow",
        ),
    ),
    hints=(
        "During one period the torque does not change, so the acceleration does not either. What are "
        "angle and speed after dt at constant acceleration a?",
        "They are q + dt q̇ + dt²/2 · a and q̇ + dt · a. Now put in a = -(kp q + kd q̇) / "
        "inertia, and collect the factors of q and of q̇.",
        "With τ held, q grows by dt·dq + ½dt²·τ/m and dq grows by dt·τ/m. Replace τ by what the "
        "law commands, and read off the factors of q and of dq.",
    ),
    wrong=(
        Wrong(
            "an Euler step, I + A dt",
            "The angle moves on with the old speed for the whole period. That is an approximation; "
            "with a held torque the exact step is as easy: the angle also gets dt²/2 times the "
            "acceleration.",
            mistakes.euler_step,
            "A held torque makes the exact solution a parabola.",
        ),
        Wrong(
            "a torque that is not held",
            "Your matrix belongs to a loop in which the torque changes all the time. Such a loop "
            "is stable for all positive gains, and a sampled one is not: hold the torque during "
            "the period.",
            mistakes.torque_never_held,
            "exp(A_closed dt) samples a continuous loop; the loop itself is not sampled.",
        ),
        Wrong(
            "the new speed moves the angle",
            "The angle moves with the speed at the end of the period: use the mean of the old and "
            "the new speed. Or the ½ of ½ a dt² is missing: add it.",
            mistakes.new_speed_first,
            "Many simulators use this step, semi-implicit Euler. The question asks for the exact "
            "one.",
        ),
        Wrong(
            "the torque with the wrong sign",
            "Your torque pushes the joint away from zero. It should be -kp q - kd q̇.",
            mistakes.pushes_away,
            "Feedback acts against the error.",
        ),
        Wrong(
            "torque taken for acceleration",
            "The inertia is missing. Divide the torque by it to get the acceleration.",
            mistakes.without_inertia,
            "A wrist is difficult because its inertia is so small.",
        ),
        Wrong(
            "the matrix transposed",
            "Rows and columns are swapped. The first row gives the new angle, the second the new "
            "speed.",
            mistakes.on_its_side,
            "Without gains the new angle is q + dt q̇: that is the first row.",
        ),
        Wrong(
            "multiplied by the inertia",
            "Divide the torque by the inertia to get the acceleration.",
            mistakes.times_inertia,
            "The heavier the joint, the smaller its acceleration.",
        ),
        Wrong(
            "kp and kd swapped",
            "kp multiplies the angle and kd the speed.",
            mistakes.gains_of_the_other,
            "The first column belongs to the angle, the second to the speed.",
        ),
        Wrong(
            "a damper that does not move the angle",
            "The torque of the damper accelerates the joint from the first moment on: -kd dt²/(2 "
            "inertia) belongs to the angle too.",
            mistakes.half_forgotten,
            "The spring and the damper each move both angle and speed.",
        ),
        Wrong(
            "an implicit step",
            "This uses the torque at the end of the step, which the computer cannot know yet. "
            "Hold the torque of the beginning. The real loop can become unstable, and with an "
            "implicit step it never would.",
            mistakes.implicit_step,
            "A stable formula does not make a stable arm.",
        ),
        Wrong(
            "the speed does not last",
            "The lower right number begins with 1: a joint without torque keeps its speed.",
            mistakes.Stepped(lambda dt: [[1.0, dt], [0.0, 0.0]]),
            "A joint without torque keeps its speed.",
        ),
    ),
    variants=(variants.held_by_exponential, variants.held_in_lists),
)


_tip = MODEL.pose(READY)[:3, 3]
_line = MODEL.joint_trajectory(
    lk.Trajectory(lk.Line(_tip, _tip + [0.1, -0.15, 0.1]), lk.Quintic(5.0)), READY, samples=33
)
_ring = lk.Circle(_tip, _tip + [0.0, -0.1, -0.2])
_circle, _quick_circle = (
    MODEL.joint_trajectory(lk.Trajectory(_ring, lk.Quintic(duration)), READY, samples=33)
    for duration in (6.0, 4.0)
)

CHOOSE_GAINS = Problem(
    name="choose_gains",
    points=3,
    outcomes=("control",),
    asks="Choose `(kp, kd)` in N m/rad and N m s/rad, each one number or seven, for springs and "
    "dampers at the joints of the `lk.BAXTER` arm (`lk.control.springs`, 200 Hz). The same gains "
    "must work on a slow line, on quicker paths, and with up to a kilogram in the gripper that "
    "the model does not know of. An arm that is released beside its target must come to rest "
    "there.",
    answer=answers.choose_gains,
    expected=lambda model: None,
    judge=Gains(),
    trials=(
        Trial("two sets of gains", (call(MODEL),), weight=0.0),
        Trial(
            "they hold the arm on a slow line",
            (Tuned((MODEL,), Loop(_line, plant=lk.BAXTER), {"rms_mm": 25.0}),),
            weight=0.0,
        ),
        Trial(
            "a quicker circle",
            (
                Tuned(
                    (MODEL,),
                    Loop(_circle, plant=lk.BAXTER),
                    {"rms_mm": 16.1, "rms_velocity_mm_s": 45.0},
                ),
            ),
            hidden.quick_tours,
            "other paths and speeds, both arms",
            weight=0.5,
        ),
        Trial(
            "back to a place from 0.1 rad off, at rest after 0.8 s",
            (Tuned((MODEL,), hidden.back(MODEL, OFF), hidden.AT_REST),),
            hidden.returns,
            "other places, both arms",
            weight=2.0,
        ),
        Trial(
            "a kilogram in the gripper",
            (
                Tuned(
                    (MODEL,),
                    Loop(_quick_circle, plant=replace(lk.BAXTER, payload=1.0), seed=1),
                    {"rms_mm": 44.0, "rms_velocity_mm_s": 75.0},
                ),
            ),
            hidden.loaded_tours,
            "other loads",
            weight=0.5,
        ),
    ),
    hints=(
        "Let every joint swing alike: choose one frequency and one damping ratio, and multiply "
        "the gains by each joint's inertia, which is on the diagonal of M.",
        "If the springs are too soft, friction and the load win. If they are too stiff, the "
        "state, which is up to 14 ms old, comes too late: stay well below one tenth of the 100 Hz "
        "at which the state is published. Draw the error over the frequency, between 0.5 and 5 Hz.",
        "Multiply the square of the frequency, in rad/s, by the inertia that each joint feels. "
        "Critical damping follows from the two. The frequency is for you to find: it is between "
        "one and three hertz.",
    ),
    wrong=(
        Wrong(
            "the same gains in every joint",
            "The last wrist joint has a fortieth of the shoulder's inertia, so gains that are "
            "mild at the shoulder are fierce at the wrist. Scale the gains by each joint's own "
            "inertia.",
            mistakes.same_for_every_joint,
            "Whether a stiffness in N m/rad is large depends on the inertia in kg m².",
        ),
        Wrong(
            "kd before kp",
            "In this order the spring is very weak, and the damper shakes the arm. Return kp "
            "first, then kd.",
            mistakes.pair_turned_round,
            "Table 1 of the report has the same slip.",
        ),
        Wrong(
            "no damping",
            "A spring without a damper swings for ever, and with an old state the swing grows. "
            "Choose kd above zero.",
            mistakes.Swings(zeta=0.0),
            "Test a damper with a sudden start, not with a smooth motion.",
        ),
    ),
    variants=(variants.ByFrequency(11.0, 0.8), variants.ByFrequency(13.0, 0.7), variants.by_hand),
)

DIAGNOSE = Problem(
    name="diagnose",
    points=3,
    outcomes=("experiment", "control"),
    asks="Given the log of a misbehaving run, return the letter of the mistake in its law.",
    answer=answers.diagnose,
    expected=lambda bug: bug.cause,
    trials=(
        Trial("a run with gravity twice", (call(Bug("c", 2, 0.74, 577)),), weight=0.0),
        Trial(
            "two more runs",
            (call(Bug("h", 0, 0.53, 291)), call(Bug("f", 1, 0.78, 875))),
            hidden.faulty_runs,
            "other mistakes, moves and moments",
        ),
    ),
    hints=(
        "Plot the error of each joint. At first it is smooth and small; at some time between 0.3 "
        "and 1.0 s it no longer is. Does it follow gravity or the speed, grow by itself, or appear "
        "only while the target accelerates?",
        "The log holds what the law commanded, and `lk.course.commanded(log, letter)` what each "
        "suspect would have commanded in the same states. How far are the two apart?",
        "Until the mistake enters, the right law commands. Compare in the second half of the run "
        "alone, and return the letter with the smallest difference.",
    ),
    wrong=(
        Wrong(
            "the whole run compared",
            "At first the law is right, so no suspect fits the whole run.",
            mistakes.compares_the_whole_run,
            "Look where the fault is, and nowhere else.",
            cure="Compare where the mistake is in the law: late in the run.",
        ),
    ),
    variants=(variants.diagnosed_by_squares,),
)

PROBLEMS = (
    AUGMENTED_PD,
    COMPUTED_TORQUE,
    SAMPLED_JOINT,
    CHOOSE_GAINS,
    DIAGNOSE,
)
