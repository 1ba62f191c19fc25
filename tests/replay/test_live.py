"""The live session: what a hand, a dial and a bad law do to the arm, without a browser."""

import re
import threading
import time

import numpy as np
import pytest

import labkit as lk
from labkit.errors import Closed, OutOfRange, TypeMismatch, UnknownName
from labkit.replay.session import Hand, LiveSession

READY = np.array(lk.robot("left").ready)
MODEL = lk.Model("left")
T_READY = MODEL.pose(READY)
SPRINGS = np.array([400.0, 400.0, 200.0, 200.0, 40.0, 40.0, 20.0])
TEXTBOOK = lk.Plant(armature=0.05, viscous=0.7)


def springy(state, target, factor=1.0):
    pull = factor * SPRINGS * (READY - state.q) - 0.15 * SPRINGS * state.dq
    return lk.JointTorque(pull + MODEL.gravity(state.q))


@pytest.fixture
def live():
    """Call with laws, and what else a session takes: a session, and the pictures that it shows."""
    made = []

    def begin(laws, target=None, things=(), **dials):
        arm = lk.Arm("left", TEXTBOOK, q0=READY, world=lk.World(things=things))
        frames = []
        target = lk.Hold(T_READY, 1.0) if target is None else target
        session = LiveSession(arm, laws, target, dials, 200.0, frames.append)
        made.append(session)
        return session, frames

    yield begin
    for session in made:
        session.close()
        session.arm.close()


def until(frames, found, tell=lambda: None):
    """Wait for a picture for which ``found`` is true, telling meanwhile; the first such."""
    limit = time.monotonic() + 60.0  # a guard against hanging only
    seen = 0
    while time.monotonic() < limit:
        for frame in frames[seen:]:
            seen += 1
            if found(frame):
                return frame
        tell()
        time.sleep(0.01)
    raise AssertionError(f"it never came; the last was {frames[-1:]}")


def push(session, force, link=7):
    session.tell({"kind": "hand", "link": link, "local": [0, 0, 0], "force": force})


def test_nothing_runs_before_start(live):
    """A notebook that is run without a reader, as by a grader, gets no thread."""
    before = threading.active_count()
    session, frames = live({"springs": springy, "still": lk.control.hold(READY)}, factor=1.0)
    session.tell({"kind": "dial", "name": "factor", "value": 2.0})
    session.tell({"kind": "law", "name": "still"})
    assert threading.active_count() == before
    assert (frames[-1]["state"], frames[-1]["law"]) == ("ready", "still")


@pytest.mark.parametrize("body", [3, 7])
def test_a_hand_pushes_any_link_as_the_law_says(body):
    """At rest the joints' springs carry the hand's force, K (q - q_d) = J^T f: tip and elbow."""
    with lk.Arm("left", TEXTBOOK, q0=READY) as arm:
        hand = Hand(arm)
        arm.world.put(hand)
        point, force = np.array([0.02, 0.0, 0.05]), np.array([3.0, -8.0, 4.0])
        hand.push(body, point, force)
        lk.run(arm, lk.Hold(READY, 6.0), springy)
        q = arm.truth().q
        _, J = arm.model.point_on(q, body, point)
        np.testing.assert_allclose(SPRINGS * (q - READY), J.T @ force, rtol=0, atol=0.05)


def test_the_soft_arm_is_a_spring_of_300_newtons_per_metre():
    """It needs an arm and nothing else; at rest 9 N move the tip by 30 mm, and no other way."""
    with lk.Arm("left", TEXTBOOK) as arm:
        law = lk.live(arm).session.law
        T, hand = arm.model.pose(arm.truth().q), Hand(arm)
        arm.world.put(hand)
        hand.push(7, np.zeros(3), [0.0, 9.0, 0.0])
        lk.run(arm, lk.Hold(T, 5.0), law)
        np.testing.assert_allclose(arm.tip()[0] - T[:3, 3], [0, 0.03, 0], rtol=0, atol=2e-3)


def test_a_hand_is_felt_and_lets_go_of_what_its_page_forgets(live):
    """While it pulls with 40 N, tau_ext of the law's state is J^T f; a silent page ends it."""
    felt = []

    def feeling(state, target):
        felt.append(state)
        return springy(state, target)

    session, frames = live({"feeling": feeling})
    session.tell({"kind": "go"})
    pushed = until(
        frames, lambda f: f["force"] and f["t"] > 0.1, lambda: push(session, [0, 0, -40])
    )
    assert until(frames, lambda f: f["t"] > pushed["t"] and not f["force"])["state"] == "running"
    session.close()
    state = max(felt, key=lambda state: np.abs(state.tau_ext).max())
    expected = MODEL.tip_jacobian(state.q).T @ [0, 0, -40, 0, 0, 0]
    np.testing.assert_allclose(state.tau_ext, expected, rtol=0, atol=0.05)


def test_a_motor_at_its_torque_limit_is_named(live):
    """Pulled down with 60 N the position mode holds; forwards it gives way at w1."""
    session, frames = live({"position mode": lk.control.hold(READY)})
    session.tell({"kind": "go"})
    down = until(frames, lambda f: f["force"] and f["t"] > 0.5, lambda: push(session, [0, 0, -60]))
    assert (down["spent"], round(down["error"], 4)) == ([], 0.0)
    forwards = until(frames, lambda f: f["error"] > 0.01, lambda: push(session, [60.0, 0, 0]))
    assert forwards["spent"] == [5]


def test_dials_laws_and_reset_begin_a_new_run(live):
    """Each takes effect at once: of the law, of the plant, another law, the start; then pause."""
    starts = []

    def law(state, target, factor):
        starts.append(factor)
        return springy(state, target, factor)

    law.reset = lambda: starts.append("reset")
    session, frames = live({"law": law, "still": lk.control.hold(READY)}, factor=1.0, payload=0.0)
    session.tell({"kind": "go"})
    until(frames, lambda f: f["t"] > 0.05)
    session.tell({"kind": "dial", "name": "factor", "value": 2.0})
    session.tell({"kind": "dial", "name": "payload", "value": 0.5})
    until(frames, lambda f: 2.0 in starts and f["error"] > 1e-3)
    assert session.arm.plant.payload == 0.5
    session.tell({"kind": "law", "name": "still"})
    until(frames, lambda f: f["law"] == "still")
    session.tell({"kind": "reset"})
    session.tell({"kind": "pause"})
    assert until(frames, lambda f: f["state"] == "ready")["error"] < 1e-3
    assert starts.count("reset") >= 2


def runs_away(state, target):
    return lk.JointTorque(60.0 * (state.q - READY + 0.1) + 60.0 * state.dq)


def wrong(state, target):
    return lk.JointTorque(target.position)


@pytest.mark.parametrize(
    ("law", "words"), [(runs_away, "lost the arm"), (wrong, "line: return lk.JointTorque")]
)
def test_a_bad_law_stops_with_its_sentence_and_the_arm_rests(live, law, words):
    """It raises or diverges: a sentence with the student's line, and the arm at rest."""
    session, frames = live({"law": law})
    session.tell({"kind": "go"})
    stopped = until(frames, lambda f: f["state"] == "stopped")
    assert re.search(words, stopped["note"]), stopped["note"]
    session.close()
    np.testing.assert_array_equal(session.arm.truth().dq, 0.0)


def test_other_cells_are_told_while_the_arm_is_live(live):
    """One thread owns the simulator; paused, the arm is everybody's, and Start goes on."""
    session, frames = live({"springs": springy})
    session.tell({"kind": "go"})
    until(frames, lambda f: f["t"] > 0.02)
    with pytest.raises(Closed, match="live in a cell"):
        lk.run(session.arm, lk.Hold(READY, 0.1), springy)
    session.tell({"kind": "pause"})
    paused = until(frames, lambda f: f["state"] == "ready")
    session.close()
    lk.run(session.arm, lk.Hold(READY, 0.1), springy)
    session.tell({"kind": "go"})
    until(frames, lambda f: f["t"] > paused["t"] + 0.12)


def test_walls_and_bands_are_drawn_and_stay(live):
    """By name; nobody can drag them."""
    far = lk.Wall(T_READY[:3, 3] + [0.3, 0.0, 0.0], (-1.0, 0.0, 0.0))
    band = lk.Spring(T_READY[:3, 3], 200.0)
    session, _ = live({"springs": springy}, things=[far, band])
    things = session.around.things()
    kinds = {name: thing["kind"] for name, thing in things.items()}
    assert kinds == {"target": "target", "thing 0": "face", "thing 1": "band"}
    assert all(thing["fixed"] for thing in things.values())


def test_a_servo_sees_where_the_tag_is_dragged(live):
    """The follower's readings, and with them the tip, go where the page puts the board."""

    class Follower:
        place = T_READY[:3, 3]

        def __call__(self, t, readings):
            for reading in readings:
                self.place = reading.T_wm[:3, 3] + [0.0, 0.0, 0.2]
            T = lk.se3.pose(T_READY[:3, :3], self.place)
            return lk.PoseSample(T, np.zeros(6), np.zeros(6))

    def servo(state, target):
        e = lk.se3.pose_error(target.pose, MODEL.pose(state.q))
        return lk.JointVelocity(np.linalg.pinv(MODEL.tip_jacobian(state.q)) @ (4.0 * e))

    world = lk.World()
    arm = lk.Arm("left", q0=READY, world=world)
    board = lk.tags.Board(world, lk.Tag(4), np.eye(4))
    place = T_READY[:3, 3] - [0.0, 0.0, 0.2]
    board.place(lk.se3.pose(np.eye(3), place))
    camera = lk.Camera(world, lk.looking_at(place + [0.5, -0.4, 0.6], place))
    target = lk.TagTarget(lk.TagStream(camera, board.tag), Follower())
    session = lk.live(arm, target, servo, rate=100.0).session
    session.around.move("tag 0", place + [0.0, 0.05, 0.0])
    lk.run(arm, session.around.target, servo, 100.0, 2.0)
    np.testing.assert_allclose(arm.tip()[0], T_READY[:3, 3] + [0, 0.05, 0], rtol=0, atol=3e-3)
    arm.close()


def test_what_is_given_wrongly_is_refused():
    """A dial nobody reads, one without a range, a start outside it, no law, a target as a law."""
    with lk.Arm("left", q0=READY) as arm:
        hold = lk.Hold(T_READY, 1.0)
        for error, given in (
            (UnknownName, {"facter": (0, 1)}),
            (TypeMismatch, {"factor": 3.0}),
            (OutOfRange, {"factor": (0, 1, 5)}),
        ):
            with pytest.raises(error):
                lk.live(arm, hold, springy, **given)
        for arguments in ((arm, hold, 3.0), ("left", hold, springy), (arm, hold, {"a": hold})):
            with pytest.raises(TypeMismatch):
                lk.live(*arguments)
