"""The questions of notebook 04."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import labkit as lk
from labkit.course import Bug, Call, Close, Loop, Tuned
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
    points=3,
    outcomes=("control",),
    asks="Mend `equation_18`. Where `arm_compensates` is true the arm carries its own weight, and the "
    "law must not add it.",
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
        "Ask of each term: is it a torque? does it belong to the arm's motion, to the target's, or to "
        "the error?",
        HINTS_SWITCH + " Its formula in the report has the unit kg m⁴/s².",
        "With V = ėᵀMė/2 + eᵀKe/2 the Coriolis term must cancel ėᵀṀė/2: write out the rate of V and see "
        "which speed C has to multiply.",
    ),
    terms=mistakes.augmented_terms,
    wrong=(
        Wrong(
            "as printed",
            "Terms b and d are still the report's: a speed that the proof of stability does not allow, and "
            "a gravity with the wrong unit.",
            mistakes.as_printed,
            "A run cannot find every error: term b shows in none.",
        ),
        Wrong(
            "the model evaluated at the target",
            "M, C and g are evaluated at the target's angles, but the arm is not there.",
            mistakes.model_at_the_target,
            "The physics happens at q, not at q_d.",
            "Use state.q.",
        ),
        Wrong(
            "the switch reversed",
            "arm_compensates is true where the arm carries its own weight: you add it there.",
            mistakes.AugmentedLaw(switch=True),
        ),
        Wrong(
            "the weight carried twice",
            "The weight is added although the arm carries it already, so the arm would rise.",
            mistakes.always_carries,
            "On Baxter the right factor for gravity is 0.",
            "Add it only where arm_compensates is false.",
        ),
        Wrong(
            "C of the target's speed",
            "C itself is evaluated at the target's speed.",
            mistakes.AugmentedLaw(at_target=True),
            "C(q, q̇) q̇_d has two speeds: one inside C, one that C multiplies.",
            "Inside C is the arm's speed; the speed that C multiplies is the target's.",
        ),
        Wrong(
            "kp and kd swapped",
            "In your law kp multiplies the error of the speeds, and kd that of the angles.",
            mistakes.AugmentedLaw(swapped=True),
            "The units tell which is which: kp is in N m/rad, kd in N m s/rad.",
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
            "inertia.",
            mistakes.gains_outside,
            "In computed torque kp is in 1/s², so it belongs inside M.",
            "Put kp e and kd ė into the acceleration, before you multiply by M.",
        ),
        Wrong(
            "the model evaluated at the target",
            "M, C and g are evaluated at the target's angles and speeds, so they do not cancel the "
            "arm's own torques.",
            mistakes.everything_at_the_target,
            "What is to cancel must be evaluated at the same place.",
            "Use state.q and state.dq.",
        ),
        Wrong(
            "the inverse of M",
            "You inverted M: that turns a torque into an acceleration.",
            mistakes.ComputedLaw(power=-1),
            "Check the units: N m or rad/s²?",
        ),
        Wrong(
            "kp and kd swapped",
            "In your law kp multiplies the error of the speeds, and kd that of the angles.",
            mistakes.ComputedLaw(swapped=True),
            "The units tell which is which: kp is in 1/s², kd in 1/s.",
        ),
        Wrong(
            "the mass matrix where the target is",
            "M is evaluated at the target's angles, but the arm is not there.",
            mistakes.TorqueBy(
                lambda x: x.model.mass_matrix(x.target.position) @ x.wish + x.drift + x.g
            ),
        ),
        Wrong(
            "only the diagonal of M",
            "You use the diagonal of M alone, but the joints accelerate each other.",
            mistakes.TorqueBy(lambda x: np.diag(x.M) * x.wish + x.drift + x.g),
        ),
    ),
    terms=mistakes.computed_terms,
    variants=(variants.computed_by_newton_euler, variants.computed_by_bias),
)


WHAT_SHOWS = Problem(
    name="what_shows",
    points=1,
    outcomes=("control", "experiment"),
    asks='Return for each term of equation 18 "-" if it is right; else the runs of the figure that show its '
    'mistake, such as "HF", or "none". Term a is done for you.',
    answer=answers.what_shows,
    trials=(
        Trial("a, which is done for you", (call("a"),), weight=0.0),
        Trial("b, c and d", (), hidden.terms_of_18),
    ),
    hints=(
        "Which runs end where they should not? Which term could do that?",
        "Mend one term alone and run the figure again: what changes?",
        "A wrong term may be too small to see in any run. Then only paper finds it.",
    ),
)

FIND_BUG = Problem(
    name="find_bug",
    points=3,
    outcomes=("experiment", "control"),
    asks="Give the letter of the mistake in a run of computed torque. It enters at some time between 0.3 "
    "and 0.8 s. `lk.course.commanded(log, letter)` says what a law with "
    "that mistake from the start commands in the states of the run, shape (N, 7). Your function is "
    "tried on runs that you have not seen.",
    answer=answers.find_bug,
    expected=lambda bug: bug.cause,
    judge=Close(),
    trials=(
        Trial("gravity left out", (call(Bug("b", 0, 0.5, 1)),), hidden.bugs, "other runs", 0.0),
        Trial(
            "two other runs",
            (call(Bug("h", 1, 0.7, 2)), call(Bug("f", 2, 0.6, 3))),
            hidden.bugs,
            "any mistake",
        ),
    ),
    hints=(
        "Each suspect says what it would have commanded; the run says what was commanded.",
        "Before the mistake enters, the right law commands. Which part of the run should you compare?",
        "Take the last third of the run, and the suspect whose commands are nearest to `log.command`.",
    ),
    wrong=(
        Wrong(
            "the whole run compared",
            "At first the law is right, so no suspect fits the whole run.",
            mistakes.compares_the_whole_run,
            "Look where the fault is, and nowhere else.",
            "Compare late in the run, where the mistake is in the law.",
        ),
        Wrong(
            "always the first",
            "You give the same letter for every run.",
            lambda log: "a",
        ),
    ),
    variants=(variants.bug_by_median,),
)


SAMPLED_JOINT = Problem(
    name="sampled_joint",
    points=4,
    core=False,
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
            "The angle moves on with the old speed for the whole period: an approximation.",
            mistakes.euler_step,
            "A held torque makes the exact solution a parabola.",
            cure="The exact step is as easy: the angle also gets dt²/2 times the acceleration.",
        ),
        Wrong(
            "a torque that is not held",
            "Your matrix belongs to a loop in which the torque changes all the time. Such a loop "
            "is stable for all positive gains, and a sampled one is not.",
            mistakes.torque_never_held,
            "exp(A_closed dt) samples a continuous loop; the loop itself is not sampled.",
            cure="Hold the torque during the period.",
        ),
        Wrong(
            "the new speed moves the angle",
            "The angle moves with the speed at the end of the period, or the ½ of ½ a dt² is missing.",
            mistakes.new_speed_first,
            "Many simulators use this step, semi-implicit Euler. The question asks for the exact "
            "one.",
            cure="Use the mean of the old and the new speed.",
        ),
        Wrong(
            "the torque with the wrong sign",
            "Your torque pushes the joint away from zero.",
            mistakes.pushes_away,
            cure="It is -kp q - kd q̇.",
        ),
        Wrong(
            "torque taken for acceleration",
            "The inertia is missing: you took a torque for an acceleration.",
            mistakes.without_inertia,
            "A wrist is difficult because its inertia is so small.",
        ),
        Wrong(
            "the matrix transposed",
            "Rows and columns are swapped. The first row gives the new angle, the second the new "
            "speed.",
            mistakes.on_its_side,
        ),
        Wrong(
            "multiplied by the inertia",
            "You multiplied by the inertia, so a heavy joint is the quicker one.",
            mistakes.times_inertia,
        ),
        Wrong(
            "kp and kd swapped",
            "In your loop kp multiplies the speed, and kd the angle.",
            mistakes.gains_of_the_other,
        ),
        Wrong(
            "a damper that does not move the angle",
            "The damper's torque accelerates the joint from the first moment on, but your angle does "
            "not feel it.",
            mistakes.half_forgotten,
            cure="-kd dt²/(2 inertia) belongs to the angle, too.",
        ),
        Wrong(
            "an implicit step",
            "This uses the torque at the end of the step, which the computer cannot know yet: with "
            "it the loop would never become unstable.",
            mistakes.implicit_step,
            "A stable formula does not make a stable arm.",
            cure="Hold the torque of the beginning.",
        ),
        Wrong(
            "the speed does not last",
            "Without any torque your joint stops at once.",
            mistakes.Stepped(lambda dt: [[1.0, dt], [0.0, 0.0]]),
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
    points=4,
    outcomes=("control",),
    asks="Choose `(kp, kd)`, seven numbers each, for springs and dampers at the joints of the arm of `model`: "
    "every joint should swing at about 1.9 Hz (1.2 to 2.4) and be damped about critically. They "
    "must also follow paths on Baxter, with up to a kilogram that the model does not know of.",
    answer=answers.choose_gains,
    judge=Close(rtol=0.6, atol=0.0, parts=("kp", "kd")),
    trials=(
        Trial("Baxter's joints", (call(MODEL),), hidden.other_rotors, "other arms", 0.0),
        Trial(
            "arms with lighter and with heavier rotors",
            (call(hidden.rotors(0.3)), call(hidden.rotors(3.0, "right"))),
            hidden.other_rotors,
            "other rotors",
            weight=2.0,
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
            weight=1.0,
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
        "Let every joint swing alike: one frequency and one damping ratio, times each joint's inertia.",
        "The inertia of joint i is entry (i, i) of model.mass_matrix(model.robot.ready). Compare m ë + kd ė + "
        "kp e = 0 with ë + 2 ζ ω ė + ω² e = 0.",
        "ω is in rad/s, not in Hz. Multiply its square by the inertia; critical damping follows.",
    ),
    wrong=(
        Wrong(
            "the same gains in every joint",
            "The last wrist joint has a fortieth of the shoulder's inertia, so gains that are "
            "mild at the shoulder are fierce at the wrist.",
            mistakes.same_for_every_joint,
            "Whether a stiffness in N m/rad is large depends on the inertia in kg m².",
            "Scale the gains by each joint's own inertia, seven numbers each.",
        ),
        Wrong(
            "kd before kp",
            "In this order the spring is very weak, and the damper shakes the arm.",
            mistakes.pair_turned_round,
            "Table 1 of the report has the same slip.",
            "Return kp first.",
        ),
        Wrong(
            "no damping",
            "A spring without a damper swings for ever, and with an old state the swing grows.",
            mistakes.Swings(zeta=0.0),
            "Test a damper with a sudden start, not with a smooth motion.",
        ),
        Wrong(
            "hertz for radians",
            "Your frequency is in Hz where rad/s belongs: springs forty times too weak.",
            mistakes.Swings(w=1.9),
        ),
        Wrong(
            "gains of one arm",
            "You return the same numbers for every arm, but these have other rotors.",
            variants.by_hand,
            "Numbers that suit one arm are no rule.",
            "Compute them from model.mass_matrix.",
        ),
    ),
    variants=(variants.ByFrequency(11.0, 0.8), variants.ByFrequency(10.0, 0.9)),
)

PROBLEMS = (AUGMENTED_PD, WHAT_SHOWS, COMPUTED_TORQUE, CHOOSE_GAINS, FIND_BUG, SAMPLED_JOINT)
