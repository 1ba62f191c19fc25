"""The questions of notebook 04."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import labkit as lk
from labkit.course import Call, Close, Gains, Loop, Tuned
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
            "the weight left out",
            "Where arm_compensates is False, nothing carries the weight: the arm sags until the "
            "springs are stretched far enough. Add g(q) there.",
            mistakes.never_carries,
            "A spring holds a weight only where it is stretched.",
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
            "springs and dampers alone",
            "The torque that the target's motion takes is missing, so the springs give it only "
            "once the arm is off its target. Add M times the acceleration and C times the speed "
            "of the target.",
            mistakes.no_motion_terms,
            "Feed-forward does the work, feedback corrects the rest.",
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
            "the report's gravity",
            "M Jᵀ (0, 0, 0.981, ...) is not a torque (look at its units). It treats gravity as a "
            "force on the tip alone, and it comes to a few percent of the weight. Use "
            "model.gravity.",
            mistakes.the_reports_gravity,
            "Check the units of every term.",
        ),
        Wrong(
            "the gains inside M",
            "This is computed torque, which comes in the next question. In the augmented law the "
            "springs and dampers act on the joints directly: keep them outside M.",
            mistakes.gains_inside,
            "In the augmented law the gain kp is in N m/rad, in computed torque it is in 1/s².",
        ),
        Wrong(
            "the springs reversed",
            "The error of the angles has the wrong sign, so the springs push the arm away. Take "
            "target minus actual.",
            mistakes.AugmentedLaw(e=-1.0),
            "One sign for every error.",
        ),
        Wrong(
            "the dampers reversed",
            "The error of the speeds has the wrong sign, so the dampers drive the arm. Take "
            "target minus actual.",
            mistakes.AugmentedLaw(de=-1.0),
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
            "only the diagonal of M",
            "The joints accelerate each other, so the numbers off the diagonal of M matter. Use "
            "the whole matrix.",
            mistakes.AugmentedLaw(beside=0.0),
            "M is a matrix: M @ ddq.",
        ),
        Wrong(
            "kp and kd swapped",
            "kp multiplies the error of the angles, and kd that of the speeds.",
            mistakes.AugmentedLaw(swapped=True),
            "The units tell which is which: kp is in N m/rad, kd in N m s/rad.",
        ),
        Wrong(
            "no springs",
            "kp times the error of the angles is missing: nothing pulls the arm back.",
            mistakes.AugmentedLaw(e=0.0),
            "Each term has a task: say which.",
        ),
        Wrong(
            "no dampers",
            "kd times the error of the speeds is missing: the arm swings about its target.",
            mistakes.AugmentedLaw(de=0.0),
            "Each term has a task: say which.",
        ),
        Wrong(
            "the Coriolis torques reversed",
            "Add C q̇_d: it is a part of the torque that the motion takes.",
            mistakes.AugmentedLaw(coriolis=-1.0),
            "The law is the equation of motion, plus springs and dampers.",
        ),
        Wrong(
            "half of the Coriolis torques",
            "model.coriolis contains the factor 1/2 already. Do not halve its torque again.",
            mistakes.AugmentedLaw(coriolis=0.5),
            "Use each term of the model as it is.",
        ),
        Wrong(
            "C transposed",
            "C q̇_d is a matrix times a vector: C @ dq_d. Yours is C.T @ dq_d.",
            mistakes.TorqueBy(
                lambda x: (
                    x.motion - x.C @ x.target.velocity + x.C.T @ x.target.velocity + x.pull + x.g
                )
            ),
            "dq @ C is not C @ dq.",
        ),
        Wrong(
            "the inertia's torque reversed",
            "Add M q̈_d: it is a part of the torque that the motion takes.",
            mistakes.TorqueBy(
                lambda x: x.motion - 2.0 * x.M @ x.target.acceleration + x.pull + x.g
            ),
            "The law is the equation of motion, plus springs and dampers.",
        ),
        Wrong(
            "C times the error of the speeds",
            "In this law C multiplies the target's speed, not the error of the speeds.",
            mistakes.TorqueBy(lambda x: x.M @ x.target.acceleration + x.C @ x.de + x.pull + x.g),
            "The law is the equation of motion for the target's motion, plus springs and dampers.",
        ),
        Wrong(
            "M times a speed",
            "M multiplies the target's acceleration, not its velocity.",
            mistakes.TorqueBy(
                lambda x: x.M @ x.target.velocity + x.C @ x.target.velocity + x.pull + x.g
            ),
            "Units: M times an acceleration is a torque.",
        ),
        Wrong(
            "the springs inside M",
            "In this law M does not multiply the springs: kp e is a torque already.",
            mistakes.TorqueBy(lambda x: x.motion + x.M @ (x.kp * x.e) + x.kd * x.de + x.g),
            "Units: say whether kp e is a torque or an acceleration.",
        ),
        Wrong(
            "the dampers inside M",
            "In this law M does not multiply the dampers: kd ė is a torque already.",
            mistakes.TorqueBy(lambda x: x.motion + x.kp * x.e + x.M @ (x.kd * x.de) + x.g),
            "Units: say whether kp e is a torque or an acceleration.",
        ),
        Wrong(
            "springs and dampers inside M",
            "In this law M multiplies only the target's acceleration: kp e and kd ė are torques "
            "already. Keep them outside M.",
            mistakes.TorqueBy(lambda x: x.motion + x.M @ x.pull + x.g),
            "Units: say whether kp e is a torque or an acceleration.",
        ),
        Wrong(
            "the weight where the target is",
            "The weight depends on where the arm is, not on where it should be: "
            "model.gravity(state.q).",
            mistakes.TorqueBy(lambda x: x.motion + x.pull + x.weight_there),
            "Evaluate the model at the arm's own angles.",
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
        Wrong(
            "C where the target is",
            "Evaluate C where the arm is: model.coriolis(state.q, state.dq).",
            mistakes.TorqueBy(
                lambda x: (
                    x.motion
                    + (x.model.coriolis(x.target.position, x.state.dq) - x.C) @ x.target.velocity
                    + x.pull
                    + x.g
                )
            ),
            "Evaluate the model at the arm's own angles.",
        ),
        Wrong(
            "the weight twice",
            "Where the arm does not carry its weight, add g(q) once.",
            mistakes.AugmentedLaw(weight=2.0),
            "Ask of each term whether another term contains it already.",
        ),
        Wrong(
            "half of the weight",
            "Where the arm does not carry its weight, add all of g(q).",
            mistakes.AugmentedLaw(weight=0.5),
            "Use each term of the model as it is.",
        ),
        Wrong(
            "the weight inside M",
            "model.gravity is a torque already. Do not multiply it by M.",
            mistakes.TorqueBy(lambda x: x.motion + x.pull + x.M @ x.g),
            "Units: M times an acceleration is a torque.",
        ),
        Wrong(
            "the bias for C",
            "`Model.bias` is C q̇ + g. With it the weight is added once too often, and C "
            "multiplies the arm's own speed.",
            mistakes.TorqueBy(
                lambda x: (
                    x.motion
                    - x.C @ x.target.velocity
                    + x.drift
                    + x.model.gravity(x.state.q)
                    + x.pull
                    + x.g
                )
            ),
            "Ask of each term whether another term contains it already.",
        ),
        Wrong(
            "a scalar product for the gains",
            "np.dot and @ add the products of all seven joints to one number. * multiplies each "
            "joint by its own gain.",
            mistakes.TorqueBy(
                lambda x: x.motion + np.dot(x.kp * np.ones(7), x.e) + x.kd * x.de + x.g
            ),
            "Each joint has its own gain.",
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
            "the weight carried twice",
            "The weight is added although the arm carries it already. inverse_dynamics and bias "
            "contain g: subtract it where arm_compensates is True.",
            mistakes.carries_twice,
            "Know what a library call contains.",
        ),
        Wrong(
            "the weight left out",
            "Where arm_compensates is False, nothing carries the weight. Add g(q) there.",
            mistakes.weightless,
            "Without g an error e = M⁻¹ g / kp remains.",
        ),
        Wrong(
            "C times the target's speed",
            "C dq_d belongs to the augmented law. In computed torque C must cancel the arm's own "
            "Coriolis torque: multiply C by the arm's own speed.",
            mistakes.targets_speed_in_coriolis,
            "Cancel what is there: C(q, dq) dq.",
        ),
        Wrong(
            "the target's acceleration left out",
            "Without the target's acceleration the arm falls behind while the target speeds up, "
            "and runs ahead while the target brakes. Add the acceleration before you multiply by "
            "M. A target at rest does not show this mistake.",
            mistakes.no_target_acceleration,
            "Feed-forward.",
        ),
        Wrong(
            "the error reversed",
            "The arm runs away from its target. Take target minus actual for both errors.",
            mistakes.runs_away,
            "Choose the sign of e once, and say it aloud.",
        ),
        Wrong(
            "the error of the angles reversed",
            "The error of the angles has the wrong sign. Take target minus actual.",
            mistakes.ComputedLaw(e=-1.0),
            "One sign for every error.",
        ),
        Wrong(
            "the error of the speeds reversed",
            "The error of the speeds has the wrong sign, so kd drives the arm. Take target minus "
            "actual.",
            mistakes.ComputedLaw(de=-1.0),
            "One sign for every error.",
        ),
        Wrong(
            "the switch reversed",
            "Where arm_compensates is True the arm carries its own weight, and the law adds none. "
            "(model.inverse_dynamics contains g already; subtract it only there.)",
            mistakes.ComputedLaw(switch=True),
            "Say who carries the weight: the arm or the law.",
        ),
        Wrong(
            "g added to inverse_dynamics",
            "The weight is added once too often: model.inverse_dynamics contains g already.",
            mistakes.ComputedLaw(twice=True),
            "Know what a function contains before you add to it.",
        ),
        Wrong(
            "no Coriolis torques",
            "C times the arm's speed is missing. Add it, although at low speed its effect is hard "
            "to see.",
            mistakes.ComputedLaw(coriolis=0.0),
            "A small effect is not zero: try a fast motion.",
        ),
        Wrong(
            "the Coriolis torques inside M",
            "C q̇ is a torque already: add it after you multiply by M, not to the acceleration.",
            mistakes.ComputedLaw(coriolis=0.0, drift=1.0),
            "Check the units: N m or rad/s²?",
        ),
        Wrong(
            "the acceleration given as a torque",
            "This is an acceleration. Multiply it by M to get a torque.",
            mistakes.ComputedLaw(power=0),
            "Check the units: N m or rad/s²?",
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
            "no springs",
            "kp times the error of the angles is missing: nothing pulls the arm back.",
            mistakes.ComputedLaw(e=0.0),
            "Each term has a task: say which.",
        ),
        Wrong(
            "no dampers",
            "kd times the error of the speeds is missing: the arm swings about its target.",
            mistakes.ComputedLaw(de=0.0),
            "Each term has a task: say which.",
        ),
        Wrong(
            "damps the motion, not the error",
            "kd multiplies the arm's own speed, so it brakes the arm even when the arm moves "
            "exactly as its target does. Multiply kd by the error of the speeds, target minus "
            "actual.",
            mistakes.TorqueBy(lambda x: x.M @ (x.wish - x.kd * x.target.velocity) + x.drift + x.g),
            "A damper is tied to the target, not to the room.",
        ),
        Wrong(
            "the Coriolis torques reversed",
            "Add C q̇: the arm needs this torque, whatever the law.",
            mistakes.ComputedLaw(coriolis=-1.0),
            "The law is the equation of motion with another acceleration.",
        ),
        Wrong(
            "half of the Coriolis torques",
            "model.coriolis contains the factor 1/2 already. Do not halve its torque again.",
            mistakes.ComputedLaw(coriolis=0.5),
            "Use each term of the model as it is.",
        ),
        Wrong(
            "the Coriolis torques twice",
            "Add C q̇ once.",
            mistakes.ComputedLaw(coriolis=2.0),
            "Use each term of the model as it is.",
        ),
        Wrong(
            "C times the error of the speeds",
            "In this law C multiplies the arm's own speed, not the error of the speeds.",
            mistakes.TorqueBy(lambda x: x.M @ x.wish + x.C @ x.de + x.g),
            "The law is the equation of motion with another acceleration.",
        ),
        Wrong(
            "C transposed",
            "C q̇ is a matrix times a vector: C @ dq. Yours is C.T @ dq.",
            mistakes.TorqueBy(lambda x: x.M @ x.wish + x.C.T @ x.state.dq + x.g),
            "dq @ C is not C @ dq.",
        ),
        Wrong(
            "the springs outside M",
            "kp e is an acceleration in this law: it belongs inside the bracket that M multiplies.",
            mistakes.TorqueBy(lambda x: x.M @ (x.wish - x.kp * x.e) + x.kp * x.e + x.drift + x.g),
            "Units: say whether kp e is a torque or an acceleration.",
        ),
        Wrong(
            "the dampers outside M",
            "kd ė is an acceleration in this law: it belongs inside the bracket that M multiplies.",
            mistakes.TorqueBy(lambda x: x.M @ (x.wish - x.kd * x.de) + x.kd * x.de + x.drift + x.g),
            "Units: say whether kp e is a torque or an acceleration.",
        ),
        Wrong(
            "the target's acceleration outside M",
            "M multiplies the whole acceleration, including the target's.",
            mistakes.TorqueBy(
                lambda x: (
                    x.M @ (x.wish - x.target.acceleration) + x.target.acceleration + x.drift + x.g
                )
            ),
            "Units: an acceleration is not a torque.",
        ),
        Wrong(
            "the target's acceleration reversed",
            "Add the target's acceleration: without any error, it is the acceleration that the "
            "arm should have.",
            mistakes.TorqueBy(
                lambda x: x.M @ (x.wish - 2.0 * x.target.acceleration) + x.drift + x.g
            ),
            "With no error, the law is the equation of motion.",
        ),
        Wrong(
            "the weight inside M",
            "model.gravity is a torque already. Do not multiply it by M.",
            mistakes.TorqueBy(lambda x: x.M @ (x.wish + x.g) + x.drift),
            "Units: M times an acceleration is a torque.",
        ),
        Wrong(
            "the weight where the target is",
            "The weight depends on where the arm is, not on where it should be: "
            "model.gravity(state.q).",
            mistakes.TorqueBy(lambda x: x.M @ x.wish + x.drift + x.weight_there),
            "Evaluate the model at the arm's own angles.",
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
            "C where the target is",
            "Evaluate C where the arm is: model.coriolis(state.q, state.dq).",
            mistakes.TorqueBy(
                lambda x: (
                    x.M @ x.wish
                    + x.model.coriolis(x.target.position, x.state.dq) @ x.state.dq
                    + x.g
                )
            ),
            "Evaluate the model at the arm's own angles.",
        ),
        Wrong(
            "the weight subtracted",
            "Gravity pulls down and the motors hold against it, so add model.gravity.",
            mistakes.TorqueBy(lambda x: x.M @ x.wish + x.drift - x.g),
            "model.gravity is the torque that holds the arm.",
        ),
        Wrong(
            "half of the weight",
            "Where the arm does not carry its weight, add all of g(q).",
            mistakes.TorqueBy(lambda x: x.M @ x.wish + x.drift + 0.5 * x.g),
            "Use each term of the model as it is.",
        ),
        Wrong(
            "only the diagonal of M",
            "The joints accelerate each other, so the numbers off the diagonal of M belong to the "
            "law. Use the whole matrix.",
            mistakes.TorqueBy(lambda x: np.diag(x.M) * x.wish + x.drift + x.g),
            "A mass matrix couples the joints.",
        ),
        Wrong(
            "M twice",
            "Multiply by M once: M times an acceleration is a torque.",
            mistakes.ComputedLaw(power=2),
            "Units: M times an acceleration is a torque.",
        ),
        Wrong(
            "a scalar product for the gains",
            "np.dot and @ add the products of all seven joints to one number. * multiplies each "
            "joint by its own gain.",
            mistakes.TorqueBy(
                lambda x: (
                    x.M @ (x.target.acceleration + np.dot(x.kp * np.ones(7), x.e) + x.kd * x.de)
                    + x.drift
                    + x.g
                )
            ),
            "Each joint has its own gain.",
        ),
    ),
    variants=(variants.computed_by_newton_euler, variants.computed_by_bias),
)

_BY_JOINT = np.array([1.0, 1.0, 2.0, 2.0, 3.0, 3.0, 4.0])

GAINS_FOR = Problem(
    name="gains_for",
    points=2,
    core=False,
    outcomes=("control",),
    asks="The error should obey ë + kd ė + kp e = 0. Give `(kp, kd)` for a `frequency` in Hz and "
    "a `damping_ratio`. The frequency is the natural one: that of the swing without damping. Both "
    "may be numbers or arrays.",
    answer=answers.gains_for,
    judge=Close(parts=("kp", "kd")),
    trials=(
        Trial("1 Hz, critically damped", (call(1.0, 1.0),), weight=0.0),
        Trial(
            "other frequencies and ratios",
            (call(2.0, 0.7), call(0.5, 1.5)),
            hidden.gains,
            "other numbers",
            0.4,
        ),
        Trial(
            "a frequency for each joint; a ratio for each joint too",
            (call(_BY_JOINT, 0.7), call(_BY_JOINT, np.array([0.5, 0.7, 1.0, 1.5, 1.0, 0.7, 0.4]))),
            hidden.gains_by_joint,
            "other numbers for each joint",
            0.6,
        ),
    ),
    hints=(
        "Compare with the equation of a damped spring, ë + 2 ζ ω ė + ω² e = 0. What is ω, in rad/s, "
        "if the frequency is in Hz?",
        "ω = 2π · frequency. Compare the two equations term by term.",
        "Compare the coefficients of e and of ė in the two equations. A frequency in Hz is not "
        "yet ω.",
    ),
    wrong=(
        Wrong(
            "kd without the 2",
            "The damping is half of what it should be. The standard form is ë + 2 ζ ω ė + ω² e = "
            "0.",
            mistakes.without_the_two,
            "Critical damping is kd² = 4 kp.",
        ),
        Wrong(
            "Hz taken for rad/s",
            "A frequency in Hz counts whole turns. Convert it to rad/s: ω = 2π · frequency.",
            mistakes.hertz_as_radians,
            "Units: 1 Hz is 6.28 rad/s.",
        ),
        Wrong(
            "kp and kd in the wrong order",
            "The two numbers are in the wrong order. Return kp first.",
            mistakes.other_way_round,
            "Table 1 of the report has the same slip, for the impedance controller.",
        ),
        Wrong(
            "kp without the square",
            "kp is in 1/s². Square ω.",
            mistakes.root_as_gain,
            "Check the unit: kp is in 1/s², ω in rad/s.",
        ),
        Wrong(
            "the damping ratio as a gain",
            "The damping ratio has no unit, and kd is in 1/s: multiply the ratio by 2 ω.",
            mistakes.damping_is_the_ratio,
            "A ratio compares with critical damping, 2 ω.",
        ),
        Wrong(
            "the square of the frequency alone",
            "kp is the square of the whole ω = 2πf, the 2π included.",
            mistakes.square_of_the_frequency_alone,
            "Write the brackets: (2π f)², not 2π f².",
        ),
        Wrong(
            "divided by 2π",
            "ω is 2π times the frequency in Hz, not the frequency divided by 2π.",
            mistakes.divided_by_turns,
            "A turn is 2π radians: more radians than turns.",
        ),
        Wrong(
            "kp in the place of ω",
            "You used kp instead of ω. kd = 2 ζ ω, and ω is the square root of kp.",
            mistakes.stiffness_for_frequency,
            "Check the unit: kd is in 1/s.",
        ),
        Wrong(
            "π for 2π",
            "One turn is 2π radians: ω = 2π f. Your ω is half of that.",
            mistakes.GainsOf(lambda w, z: ((w / 2.0) ** 2, z * w)),
            "ω = 2π f.",
        ),
        Wrong(
            "2ω for ω²",
            "kp is the square of ω, not twice ω.",
            mistakes.GainsOf(lambda w, z: (2.0 * w, 2.0 * z * w)),
            "ω² is ω times ω.",
        ),
        Wrong(
            "one kd for all joints: an inner product",
            "np.dot and @ add up the products of all joints. * multiplies joint by joint, so that "
            "each joint has its own kd.",
            mistakes.GainsOf(lambda w, z: (w**2, 2.0 * np.dot(z, w))),
            "Between arrays, * multiplies entry by entry and @ sums.",
        ),
        Wrong(
            "the damped frequency",
            "`frequency` is the natural frequency, ω. Your gains give it to the damped swing, "
            "whose frequency is ω √(1 - ζ²).",
            mistakes.GainsOf(
                lambda w, z: (
                    w**2 / (1.0 - np.minimum(z, 0.999) ** 2),
                    2.0 * z * w / np.sqrt(1.0 - np.minimum(z, 0.999) ** 2),
                )
            ),
            "The natural frequency is that of the springs without dampers.",
        ),
    ),
    variants=(variants.gains_by_roots,),
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
            "the matrix of the differential equation",
            "This matrix gives the rates of angle and speed. Give the one that leads to both "
            "after the time dt.",
            mistakes.not_a_step,
            "At dt = 0 a step is the identity.",
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
            "a series of the loop that is never sampled",
            "I + A dt + (A dt)²/2 lets the torque change during the step. The held torque adds "
            "dt²/2 · a to the angle and dt · a to the speed, and no term of higher order.",
            mistakes.second_order_series,
            "What stays constant during the step?",
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
            "the kick's rows exchanged",
            "A held torque changes the angle by dt²/2 · a and the speed by dt · a. You have "
            "exchanged the two.",
            mistakes.Stepped(kick=lambda dt, i: [dt / i, dt**2 / 2.0 / i]),
            "Angle: dt²/2. Speed: dt.",
        ),
        Wrong(
            "the free motion stands still",
            "Without a torque the angle still changes with the speed: the upper right number "
            "begins with dt.",
            mistakes.Stepped(lambda dt: np.eye(2)),
            "A joint without torque keeps its speed.",
        ),
        Wrong(
            "the torque moves the angle only",
            "A torque changes the speed as well, by dt/inertia.",
            mistakes.Stepped(kick=lambda dt, i: [dt**2 / 2.0 / i, 0.0]),
            "Integrate once for the speed, twice for the angle.",
        ),
        Wrong(
            "dt² for the speed too",
            "A constant acceleration a changes the speed by a · dt, not by a · dt².",
            mistakes.Stepped(kick=lambda dt, i: [dt**2 / 2.0 / i, dt**2 / i]),
            "Integrate once for the speed, twice for the angle.",
        ),
        Wrong(
            "the inertia for the speed alone",
            "Divide the torque by the inertia in the row of the angle as well.",
            mistakes.Stepped(kick=lambda dt, i: [dt**2 / 2.0, dt / i]),
            "A torque divided by the inertia is an acceleration.",
        ),
        Wrong(
            "the inertia for the angle alone",
            "Divide the torque by the inertia in the row of the speed as well.",
            mistakes.Stepped(kick=lambda dt, i: [dt**2 / 2.0 / i, dt]),
            "A torque divided by the inertia is an acceleration.",
        ),
        Wrong(
            "no free motion",
            "Your matrix loses the state before the step: add the free motion [[1, dt], [0, 1]] "
            "to the effect of the torque.",
            mistakes.Stepped(lambda dt: np.zeros((2, 2))),
            "A joint without torque keeps its speed.",
        ),
        Wrong(
            "the speed does not last",
            "The lower right number begins with 1: a joint without torque keeps its speed.",
            mistakes.Stepped(lambda dt: [[1.0, dt], [0.0, 0.0]]),
            "A joint without torque keeps its speed.",
        ),
        Wrong(
            "only the damper",
            "kp is left out: the spring pulls as well.",
            mistakes.PullOnly(0.0, 1.0),
            "tau = -kp q - kd dq.",
        ),
        Wrong(
            "only the spring",
            "kd is left out: the damper brakes as well.",
            mistakes.PullOnly(1.0, 0.0),
            "tau = -kp q - kd dq.",
        ),
    ),
    variants=(variants.held_by_exponential, variants.held_in_lists),
)

_random = np.random.default_rng(4)
_poses = READY + _random.uniform(-0.4, 0.4, (12, 7))
_weights = np.array([MODEL.gravity(q) for q in _poses])
_clean = call(0.7 * _weights, _weights)
_noisy = call(0.9 * _weights + _random.standard_normal((12, 7)), _weights)
_nothing = call(0.5 * _random.standard_normal((12, 7)), _weights)

GRAVITY_FACTOR = Problem(
    name="gravity_factor",
    points=3,
    core=False,
    outcomes=(
        "control",
        "experiment",
    ),
    asks="At rest in N poses you read the torques that hold the arm, `tau_hold`, and compute the "
    "model's `gravity_model`, both of shape (N, 7). Give the one factor for the model's gravity "
    "that explains the torques best, in the sense of least squares.",
    answer=answers.gravity_factor,
    judge=Close(rtol=1e-6, atol=1e-9),
    trials=(
        Trial(
            "12 poses without noise",
            (_clean,),
            hidden.clean_poses,
            "other poses",
            weight=0.0,
        ),
        Trial(
            "12 poses with noise",
            (_noisy,),
            hidden.noisy_poses,
            "more and fewer poses",
        ),
        Trial(
            "torques that have nothing to do with gravity",
            (_nothing,),
            hidden.no_weight_poses,
            "torques of the other sign",
        ),
    ),
    hints=(
        "There is one unknown, k, and there are 7 N equations, tau = k g. For which k is the sum "
        "of (tau - k g)² least?",
        "Differentiate that sum with respect to k and set the derivative to zero: k is a fraction "
        "of two sums.",
        "Write the sum of squares of τ - k g over all poses and joints, set its derivative with "
        "respect to k to zero, and solve. One fraction remains.",
    ),
    wrong=(
        Wrong(
            "the mean of ratios",
            "The axis of joint s0 is vertical and carries no weight, so its ratio divides by "
            "zero; in the wrist the noise is divided by almost zero. Use least squares, in which "
            "small torques count little.",
            mistakes.mean_of_ratios,
            "Never divide by a measurement that may be zero.",
        ),
        Wrong(
            "a minus between model and torques",
            "gravity_model is the torque that holds the arm, and so is that of the motors. Leave "
            "the minus out.",
            mistakes.turned_sign,
            "g(q) is what the motors must give, not what the weight does.",
        ),
        Wrong(
            "the regression the other way round",
            "This fit explains the model by the torques, and the noise in them makes the factor "
            "too large. Fit the torques to the model.",
            mistakes.other_regression,
            "Least squares is not symmetric: it puts all of the noise on one side of the equation.",
        ),
        Wrong(
            "a ratio of lengths",
            "A length has no sign and no direction, so noise alone gives a factor too. Use least "
            "squares.",
            mistakes.ratio_of_lengths,
            "Project, do not compare lengths.",
        ),
        Wrong(
            "a ratio of sums",
            "Torques of opposite sign cancel in the sums before they are compared. Use least "
            "squares.",
            mistakes.ratio_of_sums,
            "Numbers of opposite sign cancel in a sum.",
        ),
        Wrong(
            "a line with an offset",
            "This is the slope of a line with an offset. Fit one factor and no offset.",
            mistakes.with_an_offset,
            "Which model is fitted?",
        ),
        Wrong(
            "the torques explain the model",
            "This is a factor of the torques. For the factor of the model, divide by the model's "
            "squares, not by the torques'.",
            mistakes.model_over_torque,
            "Say which quantity explains the other.",
        ),
        Wrong(
            "one over the factor",
            "You return the reciprocal. Look at tau = factor · g again.",
            mistakes.one_over_the_factor,
            "Say which quantity explains the other.",
        ),
        Wrong(
            "a mean over poses",
            "A pose with small torques says little about the factor, but here it counts as much "
            "as any other. Sum over all joints and poses first.",
            mistakes.mean_over_poses,
            "Sum, then divide.",
        ),
        Wrong(
            "a mean over joints",
            "A joint without load says nothing about the factor, but here it counts as much as "
            "any other. Sum over all joints and poses first.",
            mistakes.mean_over_joints,
            "Sum, then divide.",
        ),
        Wrong(
            "the distance from 1",
            "This is how far the factor is from 1. Give the factor itself.",
            mistakes.what_is_missing,
            "1 is right; 0 leaves gravity out.",
        ),
        Wrong(
            "one pose alone",
            "This is the factor of the first pose. Use all poses.",
            mistakes.Fit(lambda t, g: np.sum(t[0] * g[0]) / np.sum(g[0] ** 2)),
            "More data, less noise.",
        ),
        Wrong(
            "the last pose alone",
            "This is the factor of the last pose. Use all poses.",
            mistakes.Fit(lambda t, g: np.sum(t[-1] * g[-1]) / np.sum(g[-1] ** 2)),
            "More data, less noise.",
        ),
        Wrong(
            "a median of ratios",
            "Ratios of small numbers are mostly noise, and so is their median. Use least squares, "
            "in which small numbers count little.",
            mistakes.Fit(lambda t, g: np.nanmedian(t / g)),
            "Divide two sums; do not average ratios.",
        ),
        Wrong(
            "a correlation",
            "A correlation says how well a factor explains the torques, not how large the factor "
            "is.",
            mistakes.Fit(lambda t, g: np.corrcoef(t.ravel(), g.ravel())[0, 1]),
            "A correlation is not a slope.",
        ),
        Wrong(
            "no denominator",
            "Σ τ g is not yet a factor: divide it by Σ g².",
            mistakes.Fit(lambda t, g: np.sum(t * g)),
            "A factor has no unit.",
        ),
        Wrong(
            "a ratio of the largest",
            "Here two single numbers decide. Least squares uses all of them.",
            mistakes.Fit(lambda t, g: np.abs(t).max() / np.abs(g).max()),
            "More data, less noise.",
        ),
        Wrong(
            "a ratio of the mean sizes",
            "Without signs the noise adds up instead of cancelling. Use least squares: Σ τ g / Σ "
            "g².",
            mistakes.Fit(lambda t, g: np.abs(t).mean() / np.abs(g).mean()),
            "Keep the signs.",
        ),
        Wrong(
            "products without their signs",
            "In |τ g| the noise adds up instead of cancelling: keep the signs.",
            mistakes.Fit(lambda t, g: np.abs(t * g).sum() / np.sum(g**2)),
            "Keep the signs.",
        ),
        Wrong(
            "a difference for the factor",
            "The mean of τ - g is a torque. A factor has no unit.",
            mistakes.Fit(lambda t, g: np.mean(t - g)),
            "A factor has no unit.",
        ),
        Wrong(
            "in percent",
            "This is a percentage. Give the factor itself.",
            mistakes.Fit(lambda t, g: 100.0 * np.sum(t * g) / np.sum(g**2)),
            "Say the unit of every number.",
        ),
        Wrong(
            "what is left over",
            "This is the residual. Give the factor that makes it smallest.",
            mistakes.Fit(lambda t, g: np.sum((t - g * np.sum(t * g) / np.sum(g**2)) ** 2)),
            "A residual is what a fit leaves over.",
        ),
    ),
    variants=(variants.factor_by_lstsq,),
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
            "gains tuned on the slow line only",
            "These gains are good enough for the slow line only. Friction, the quicker circle and "
            "the load stretch such soft springs three times as far as necessary: try those as "
            "well.",
            mistakes.Swings(6.0),
            "Gains that were tried on one motion suit that motion.",
        ),
        Wrong(
            "too stiff for an old state",
            "The arm shakes, because it reacts to where it was 14 ms ago. Lower the gains: a loop "
            "must be slower than the delay of its measurements.",
            mistakes.Swings(25.0),
            "Delay times bandwidth must stay well below one.",
        ),
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
            "the report's gains",
            "With 8 N m/rad at the shoulder, one newton metre of friction leaves an error of an "
            "eighth of a radian, as the report's figures show. Make the springs stiffer.",
            mistakes.the_reports_gains,
            "The plateaus in the report's figures are friction divided by kp.",
        ),
        Wrong(
            "too little damping",
            "Released beside its target, the arm swings for seconds, which a smooth motion does "
            "not show. Critical damping is kd = 2 m ω; use at least half of it.",
            mistakes.Swings(zeta=0.1),
            "Test a damper with a sudden start, not with a smooth motion.",
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

PROBLEMS = (
    AUGMENTED_PD,
    COMPUTED_TORQUE,
    GAINS_FOR,
    SAMPLED_JOINT,
    GRAVITY_FACTOR,
    CHOOSE_GAINS,
)
