"""Plain loops to compare with `run`: calls of an engine without classes, log or checks.

Their physics are those of `run`, with limits of the torques and stops of the joints.
"""

import tempfile

import numpy as np

import labkit as lk
from labkit.quiet import quiet

JOINTS = range(7)
MOST = lk.robot("left").effort
LEAST = -MOST


def pybullet():
    """The engine, imported only when it is needed, because few machines have wheels for it."""
    with quiet():
        import pybullet
    return pybullet


def open_arm(urdf):
    """Load the arm of a URDF text into a new world; return its client and its body."""
    bullet = pybullet()
    client = bullet.connect(bullet.DIRECT)
    with quiet(), tempfile.NamedTemporaryFile("w", encoding="utf-8", suffix=".urdf") as file:
        file.write(urdf)
        file.flush()
        flags = bullet.URDF_USE_INERTIA_FROM_FILE
        body = bullet.loadURDF(file.name, useFixedBase=True, flags=flags, physicsClientId=client)
    bullet.setTimeStep(1e-3, physicsClientId=client)
    bullet.setGravity(0, 0, -9.81, physicsClientId=client)
    for j in range(-1, 7):
        bullet.changeDynamics(body, j, linearDamping=0, angularDamping=0, jointDamping=0,
                              physicsClientId=client)  # fmt: skip
    bullet.setJointMotorControlArray(body, JOINTS, bullet.VELOCITY_CONTROL, forces=[0.0] * 7,
                                     physicsClientId=client)  # fmt: skip
    return client, body


def hand_loop(client, body, target, controller, seconds):
    """Let the arm follow the target at 1 kHz from its start; return the last q."""
    bullet = pybullet()
    q = target(0.0).position
    for j in JOINTS:
        bullet.resetJointState(body, j, q[j], 0.0, physicsClientId=client)
    for k in range(round(seconds * 1000)):
        joints = bullet.getJointStates(body, JOINTS, physicsClientId=client)
        q, dq = np.array([j[0] for j in joints]), np.array([j[1] for j in joints])
        command = controller(lk.State(k * 1e-3, q, dq), target(k * 1e-3))
        tau = np.minimum(np.maximum(command.value, LEAST), MOST)
        bullet.setJointMotorControlArray(body, JOINTS, bullet.TORQUE_CONTROL, forces=tau.tolist(),
                                         physicsClientId=client)  # fmt: skip
        bullet.stepSimulation(physicsClientId=client)
    return np.array([j[0] for j in bullet.getJointStates(body, JOINTS, physicsClientId=client)])
