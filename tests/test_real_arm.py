"""A real arm in the place of the simulated one: here a simulated arm in another process.

It is reached over a local socket and lives in real time, with limits and a watchdog of its own.
"""

import json
import socket
import subprocess
import sys
import time
from contextlib import contextmanager

import numpy as np
import pytest
from numpy.testing import assert_allclose

import labkit as lk
from labkit.arm_adapters import SILENCE, WallClock
from labkit.errors import ArmLost, ControllerError

SERVER = """
import json, socket, sys, time
import numpy as np
import labkit as lk

kinds = {kind.__name__: kind for kind in (lk.JointPosition, lk.JointVelocity, lk.JointTorque)}
with lk.Arm("left", lk.Plant(gravity_compensation=True)) as arm, socket.socket() as door:
    door.bind(("127.0.0.1", 0))
    door.listen(1)
    print(door.getsockname()[1], flush=True)
    line, _ = door.accept()
    line.setblocking(False)
    start, heard, buffer, harm, gone = time.monotonic(), 0.0, b"", "", False
    while not gone or np.abs(arm.truth().dq).max() > 1e-6:
        for _ in range(20):  # in real time, as far as this machine can
            if arm.world.t < time.monotonic() - start:
                arm.world.step()
        try:
            new = line.recv(65536)
            gone = gone or not new
            buffer += new
        except BlockingIOError:
            time.sleep(0.0005)
        except OSError:
            gone = True
        *texts, buffer = buffer.split(b"\\n")
        for text in texts:
            kind, value = json.loads(text)
            if kind in kinds:
                arm.apply(kinds[kind](value))
            elif kind == "stop":
                arm.stop()
            elif kind == "harm":
                harm = value
            if kind == "state" and harm == "hang up":
                line.close()
                gone = True
            elif kind == "state" and harm != "silence":
                q, dq = arm.truth()[1:3]
                q = [float("nan")] * 7 if harm == "nan" else q.tolist()
                t = 0.5 if harm == "frozen" else arm.world.t
                line.sendall(json.dumps([t, q, dq.tolist()]).encode() + b"\\n")
    print(json.dumps(np.abs(arm.truth().dq).max()), flush=True)
"""
"""Its watchdog is the plant's `command_timeout`: it holds its place when commands stop."""


class Remote(WallClock):
    """The arm at the other end of a socket."""

    def __init__(self, port):
        self.robot = lk.robot("left")
        self.sent = []
        self._line = socket.create_connection(("127.0.0.1", port), timeout=5.0)
        self._file = self._line.makefile("r")

    def say(self, kind, value=None):
        self.sent.append(kind)
        self._line.sendall(json.dumps([kind, value]).encode() + b"\n")

    def state(self):
        self.say("state")
        t, *joints = json.loads(self._file.readline() or "null")
        return lk.State(t, *map(np.array, joints))

    def apply(self, command):
        self.say(type(command).__name__, command.value.tolist())

    def stop(self):
        self.say("stop")

    def close(self):
        self._file.close()
        self._line.close()


@contextmanager
def remote():
    """Such an arm; at the end its own last word is that it is at rest."""
    with subprocess.Popen(
        [sys.executable, "-c", SERVER], stdout=subprocess.PIPE, text=True
    ) as process:
        arm = Remote(int(process.stdout.readline()))
        try:
            yield arm
        finally:
            arm.close()
            assert float(process.stdout.readline()) < 1e-6
            assert process.wait(timeout=20) == 0


def way(duration=1.0):
    q = lk.robot("left").neutral
    return lk.Trajectory(lk.Line(q, q + [0.1, 0, 0, -0.1, 0, 0, 0]), lk.Quintic(duration))


def follow(state, target):
    return lk.JointVelocity(target.velocity + 5.0 * (target.position - state.q))


def harmed(arm, harm, after=0.4):
    """A controller that follows until it tells the arm to misbehave."""

    def controller(state, target):
        if "harm" not in arm.sent and state.t > after:
            arm.say("harm", harm)
        return follow(state, target)

    return controller


def test_run_drives_an_arm_in_another_process_in_real_time(tmp_path):
    """The log has the wall's times; metrics, figures and replays work on it, saved and loaded."""
    with remote() as arm:
        before = time.monotonic()
        log = lk.run(arm, way(), follow, rate=50.0, duration=3.0)  # time to arrive on any machine
        assert time.monotonic() - before >= 1.0
    assert log.t[-1] >= 1.0 - 1e-9
    assert (np.diff(log.t) > 0.0).all()
    assert_allclose(log.q[-1], way()(1.0).position, rtol=0, atol=0.05)
    assert log.plant.name == "real"
    log.save(tmp_path / "run.npz")
    back = lk.Log.load(tmp_path / "run.npz")
    assert lk.metrics.summary(back) == lk.metrics.summary(log)
    assert lk.plotting.describe(back).startswith("Tracking by follow on the real left arm")
    assert lk.replay.motion_of(back, "A real arm").data()["side"] == "left"


def test_commands_are_cut_to_the_limits_before_they_are_sent():
    """A real arm never receives more than its speed limit; the log keeps what was asked for."""
    given = []

    class Lamb(Remote):
        def apply(self, command):
            given.append(command.value)
            super().apply(command)

    with remote() as arm:
        arm.__class__ = Lamb
        log = lk.run(arm, lk.Hold(arm.robot.neutral, 0.2), lambda s, x: lk.JointVelocity([9.0] * 7))
    assert (np.abs(given) <= log.robot.speed).all()
    assert log.saturated.any()
    assert (log.command == 9.0).all()


@pytest.mark.parametrize(
    ("harm", "words"),
    [
        ("hang up", "the arm stopped answering at t = .* log up to here is in error"),
        ("silence", r"the arm stopped answering at t = .* \(TimeoutError: .*; it was told to stop"),
        ("nan", "the arm's answer at t = .* its q holds nan at index 0; .*; it was told to stop"),
        ("frozen", "the arm's state has not changed since t = .* s; it was told to stop"),
    ],
)
def test_an_arm_that_is_lost_comes_to_rest_and_its_log_is_kept(harm, words):
    """One that hangs up, is silent, sends NaN or freezes ends the run, and its rows are kept."""
    with remote() as arm, pytest.raises(ArmLost, match=words) as caught:
        lk.run(arm, way(2.0), harmed(arm, harm), rate=50.0)
    log = caught.value.log
    assert 2 < len(log) < 100
    assert np.isfinite(log.q).all()
    if harm == "frozen":
        assert log.t[-1] > SILENCE


def test_whatever_a_controller_does_the_arm_is_stopped():
    """A division by zero after 11 ticks is named, the arm is sent a stop, and 11 rows are kept."""
    ticks = iter(range(100))

    def broken(state, target):
        if next(ticks) > 10:
            raise ZeroDivisionError("oh")
        return follow(state, target)

    with remote() as arm:
        with pytest.raises(ControllerError, match=r"broken failed at .*visionError: oh") as caught:
            lk.run(arm, way(), broken, rate=50.0, duration=10.0)
        assert arm.sent[-1] == "stop"
    assert len(caught.value.log) == 11
