"""The gains with which the five controllers are compared, and the rate of each controller.

One set of gains is for arms whose state is exact and fresh, the other for arms that publish it
late and noisy, as Baxter does.  There a loop must be slow compared with the age of its data: the
state is up to 14 ms old and a command acts for 5 ms, so bandwidths stay below about 20 rad/s.  The
derivative gain of the velocity controllers is tuned by `speed_gains`; on the ideal arm, whose
drives do not lag, it is 0.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from labkit import Model, Plant
from labkit.control import Controller

from .joint_impedance import JointImpedance
from .joint_torque import AugmentedPD, ComputedTorque, IntegralTorque
from .joint_velocity import JointVelocityPD
from .workspace_impedance import WorkspaceImpedance
from .workspace_velocity import WorkspaceVelocityPD


@dataclass(frozen=True, eq=False)
class Candidate:
    """A controller with its rate and its kind of target.

    Attributes:
        controller: The controller.
        rate: How often the controller is called, in [Hz].
        joints: Whether the controller follows joint angles; otherwise it follows poses.
    """

    controller: Controller
    rate: float
    joints: bool

    def target(self, model: Model, trajectory: Any, q0: Any) -> Any:
        """The target for the controller along a trajectory of poses, from joint angles q0, (7,)."""
        return model.joint_trajectory(trajectory, q0) if self.joints else trajectory


def course_controllers(model: Model, plant: Plant | None = None) -> dict[str, Candidate]:
    """The five controllers of the course.

    Args:
        model: The model of the arm that the controllers use.
        plant: What the arm is like; None takes the model's own plant.
    """
    plant = plant or model.plant
    gravity, slow = not plant.gravity_compensation, _slow(plant)
    fast = 200.0 if slow else 1000.0
    K, D = _JOINT_SPRING[slow], _JOINT_DAMPER[slow]
    return {
        "workspace velocity": Candidate(WorkspaceVelocityPD(model, *_SPEED[slow]), 200.0, False),
        "joint velocity": Candidate(JointVelocityPD(*_SPEED[slow]), 200.0, True),
        "joint torque": Candidate(ComputedTorque(model, *_COMPUTED[slow], gravity), fast, True),
        "workspace impedance": Candidate(
            WorkspaceImpedance(model, K=TIP_SPRING, gravity=gravity), fast, False
        ),
        "joint impedance": Candidate(JointImpedance(model, K, D, gravity=gravity), fast, True),
    }


def variants(model: Model, plant: Plant | None = None) -> dict[str, Candidate]:
    """The other forms of the torque law, and both impedances with a prescribed inertia."""
    plant = plant or model.plant
    gravity, slow = not plant.gravity_compensation, _slow(plant)
    fast = 200.0 if slow else 1000.0
    K, D = _JOINT_SPRING[slow], _JOINT_DAMPER[slow]
    return {
        "computed torque with an integral": Candidate(
            IntegralTorque(model, *_COMPUTED[slow], gravity=gravity), fast, True
        ),
        "augmented PD": Candidate(AugmentedPD(model, *_AUGMENTED[slow], gravity), fast, True),
        "shaped workspace impedance": Candidate(
            WorkspaceImpedance(model, K=TIP_SPRING, inertia=_TIP_INERTIA[slow], gravity=gravity),
            fast,
            False,
        ),
        "shaped joint impedance": Candidate(
            JointImpedance(model, K, D, inertia=_JOINT_INERTIA[slow], gravity=gravity), fast, True
        ),
    }


def all_controllers(model: Model, plant: Plant | None = None) -> dict[str, Candidate]:
    """All controllers that the campaign can run."""
    return {**course_controllers(model, plant), **variants(model, plant)}


def _slow(plant: Plant) -> bool:
    """Whether the arm's state is late, infrequent or noisy."""
    return bool(plant.state_rate or plant.state_delay or any(plant.velocity_noise))


KP = 3.0
"""Proportional gain of the velocity controllers on the realistic arm, in [1/s]: the report's."""
KD = 0.6
"""Derivative gain of the velocity controllers on the realistic arm, found by `speed_gains`."""

# The first of each pair is for fresh states.  Stiffness falls towards the wrist with the inertia,
# which without rotors is below 0.001 kg m^2 at w2.
_SPEED = ((10.0, 0.0), (KP, KD))  # 1/s, no unit
_COMPUTED = ((400.0, 40.0), (225.0, 30.0))  # 1/s^2, 1/s
_AUGMENTED = (
    ((400.0, 400.0, 200.0, 200.0, 10.0, 10.0, 1.0), (80.0, 80.0, 20.0, 20.0, 2.0, 2.0, 0.2)),
    ((200.0, 200.0, 100.0, 100.0, 15.0, 15.0, 10.0), (30.0, 30.0, 15.0, 15.0, 2.0, 2.0, 1.5)),
)  # N m/rad, N m s/rad
_JOINT_SPRING = (
    (200.0, 200.0, 100.0, 100.0, 10.0, 10.0, 2.0),
    (100.0, 100.0, 60.0, 60.0, 10.0, 10.0, 5.0),
)  # N m/rad
_JOINT_DAMPER = (
    (40.0, 40.0, 15.0, 12.0, 1.0, 1.0, 0.05),
    (20.0, 20.0, 12.0, 12.0, 2.0, 2.0, 1.5),
)  # N m s/rad
_JOINT_INERTIA = (
    (2.0, 2.0, 1.0, 0.5, 0.1, 0.1, 0.05),
    (3.0, 3.0, 1.0, 1.0, 0.2, 0.2, 0.1),
)  # kg m^2
TIP_SPRING = (300.0, 300.0, 300.0, 20.0, 20.0, 20.0)  # N/m, N m/rad
_TIP_INERTIA = ((5.0, 5.0, 5.0, 0.1, 0.1, 0.1), (5.0, 5.0, 5.0, 0.3, 0.3, 0.3))  # kg, kg m^2
