"""The live session: what a hand, a dial and a bad law do to the arm, without a browser."""

import re
import sys
import threading
import time

import numpy as np
import pytest

import labkit as lk
from labkit.errors import Closed, OutOfRange, TypeMismatch, UnknownName
from labkit.replay.hand import FRESH, Hand
from labkit.replay.session import TURN, Session
from labkit.replay.view import read_dials

READY = np.array(lk.robot("left").ready)
T_READY = lk.Model("left").pose(READY)
SPRINGS = np.array([400.0, 400.0, 200.0, 200.0, 40.0, 40.0, 20.0])


def springy(state, target, factor=1.0):
    gravity = MODELS[threading.get_ident()].gravity(state.q)
    return lk.JointTorque(
        factor * SPRINGS * (READY - state.q) - 0.15 * SPRINGS * state.dq + gravity
    )


class _Models(dict):
    def __missing__(self, key):
        self[key] = lk.Model("left")
        return self[key]


MODELS = _Models()
TEXTBOOK = lk.Plant(armature=0.05, viscous=0.7)


@pytest.fixture
def live():
    """Call with laws, and what else a session takes: a session, and the pictures that it shows."""
    made = []

    def begin(laws, target=None, things=(), plant=TEXTBOOK, **dials):
        arm = lk.Arm("left", plant, q0=READY, world=lk.World(things=things))
        frames = []
        found = read_dials(dials, plant, laws)
        target = lk.Hold(T_READY, 1.0) if target is None else target
        session = Session(arm, laws, target, found, 200.0, frames.append)
        made.append((session, arm))
        return session, frames

    yield begin
    for session, arm in made:
        session.close()
        arm.close()


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
    session, frames = live({"springs": springy, "still": lk.control.hold(READY)}, factor=(0.5, 4.0))
    session.tell({"kind": "dial", "name": "factor", "value": 2.0})
    session.tell({"kind": "law", "name": "still"})
    assert threading.active_count() == before
    assert frames[-1]["state"] == "ready"
    assert frames[-1]["law"] == "still"


def test_a_hand_pushes_any_link_as_statics_says():
    """At rest the joints' springs carry the hand's force, K (q - q_d) = J^T f: tip and elbow."""
    for body in (3, 7):
        with lk.Arm("left", TEXTBOOK, q0=READY) as arm:
            hand = Hand(arm)
            arm.world.put(hand)
            point, force = np.array([0.02, 0.0, 0.05]), np.array([3.0, -8.0, 4.0])
            hand.push(body, point, force)
            lk.run(arm, lk.Hold(READY, 6.0), springy)
            _, q, dq, _ = arm.truth()
            assert np.abs(dq).max() < 2e-3
            _, J = arm.model.point_on(q, body, point)
            np.testing.assert_allclose(SPRINGS * (q - READY), J.T @ force, rtol=0, atol=0.05)


def test_the_arm_feels_the_hand_in_a_world_without_things(live):
    """While the hand pulls with 40 N, tau_ext of the law's state is J^T f."""
    felt = []

    def feeling(state, target):
        felt.append(state)
        return springy(state, target)

    session, frames = live({"feeling": feeling})
    session.tell({"kind": "go"})
    push(session, [0.0, 0.0, -40.0])
    until(frames, lambda f: f["force"] and f["t"] > 0.1, lambda: push(session, [0, 0, -40]))
    session.close()
    state = max(felt, key=lambda state: np.abs(state.tau_ext).max())
    expected = lk.Model("left").tip_jacobian(state.q).T @ [0, 0, -40, 0, 0, 0]
    np.testing.assert_allclose(state.tau_ext, expected, rtol=0, atol=0.05)


def test_a_motor_at_its_torque_limit_is_named(live):
    """Pulled forwards with 60 N the position mode gives way at w1; pulled down it holds."""
    session, frames = live({"position mode": lambda state, target: lk.JointPosition(READY)})
    session.tell({"kind": "go"})
    push(session, [0.0, 0.0, -60.0])
    down = until(frames, lambda f: f["force"] and f["t"] > 0.5, lambda: push(session, [0, 0, -60]))
    assert (down["spent"], round(down["error"], 4)) == ([], 0.0)
    forwards = until(frames, lambda f: f["error"] > 0.01, lambda: push(session, [60.0, 0, 0]))
    assert forwards["spent"] == [5]


def test_the_force_ends_when_nothing_is_heard(live):
    """A hand whose page fell silent lets go, and the pictures go on."""
    session, frames = live({"springs": springy})
    session.tell({"kind": "go"})
    hand = {"kind": "hand", "link": 7, "local": [0, 0, 0], "to": [0.7, 0.5, 0.1]}
    pushed = until(frames, lambda f: f["force"], tell=lambda: session.tell(hand))
    gone = until(frames, lambda f: f["t"] > pushed["t"] and f["force"] is None)
    assert gone["state"] == "running"
    assert FRESH <= 0.2


def test_reset_puts_the_arm_back_also_after_stop(live):
    """Where no thread runs any more, Reset is done at once, not at the next start."""
    session, frames = live({"springs": springy})
    session.tell({"kind": "go"})
    push(session, [0.0, 0.0, -20.0])
    until(frames, lambda f: f["error"] > 1e-3)
    session.tell({"kind": "close"})
    until(frames, lambda f: f["state"] == "closed")
    session.close()
    session.tell({"kind": "reset"})
    assert frames[-1]["state"] == "ready"
    np.testing.assert_allclose(frames[-1]["q"], READY, rtol=0, atol=1e-5)


def test_dials_take_effect_and_a_kept_run_says_which(live):
    """A dial of the law and one of the plant: both are in the log of the run that is kept."""
    session, frames = live({"springs": springy}, factor=(0.5, 4.0, 1.0), payload=(0.0, 1.0))
    session.tell({"kind": "go"})
    session.tell({"kind": "dial", "name": "factor", "value": 2.0})
    session.tell({"kind": "dial", "name": "payload", "value": 0.5})
    until(frames, lambda f: f["t"] > 0.3)
    session.tell({"kind": "keep"})
    until(frames, lambda f: f["kept"])
    (log,) = session.logs
    assert frames[-1]["kept"] == [round(log.t[-1], 1)]
    assert log.plant.payload == 0.5
    assert log.controller == "springs, factor 2"
    assert log.q[-1, 1] != pytest.approx(log.q[0, 1], abs=1e-4), "the payload pulls the arm down"
    session.close()
    assert session.arm.plant == TEXTBOOK


def runs_away(state, target):
    return lk.JointTorque(60.0 * (state.q - READY + 0.1) + 60.0 * state.dq)


def wrong(state, target):
    return lk.JointTorque(target.position)


def slow(state, target):
    time.sleep(0.02)
    return lk.JointVelocity(np.zeros(7))


@pytest.mark.parametrize(
    ("law", "words"),
    [
        (runs_away, "lost the arm.*check the sign"),
        (wrong, "asked the target's sample for its position.*line: return lk.JointTorque"),
        (slow, "law takes .* ms, but is called every 5 ms"),
    ],
)
def test_a_bad_law_stops_with_its_sentence_and_the_arm_rests(live, law, words):
    """It raises, diverges or is too slow: one sentence, and the arm at rest."""
    session, frames = live({"law": law})
    session.tell({"kind": "go"})
    stopped = until(frames, lambda f: f.get("state") == "stopped")
    assert re.search(words, stopped["note"]), stopped["note"]
    session.close()
    np.testing.assert_array_equal(session.arm.truth().dq, 0.0)


def test_a_law_that_never_returns_is_named_at_the_next_message(live, monkeypatch):
    """Nothing ends it but a new kernel, and the page says so."""
    monkeypatch.setattr("labkit.replay.session.PATIENCE", 0.1)
    free = threading.Event()

    def law(state, target):
        free.wait()
        return springy(state, target)

    session, frames = live({"law": law})
    session.tell({"kind": "go"})
    told = until(frames, lambda f: f["kind"] == "note", lambda: session.tell({"kind": "here"}))
    assert told["note"].startswith("law has not returned")
    free.set()
    until(frames, lambda f: f["kind"] == "frame" and f["t"] > 0.0)


def test_two_laws_pause_step_and_reset(live):
    """The arm waits, advances by a step, changes its law and goes back to where it began."""
    session, frames = live({"springs": springy, "still": lk.control.hold(READY)})
    session.tell({"kind": "go"})
    push(session, [0.0, 0.0, -20.0])
    until(frames, lambda f: f["error"] > 1e-3)
    session.tell({"kind": "pause"})
    paused = until(frames, lambda f: f["state"] == "paused")
    session.tell({"kind": "law", "name": "still"})
    session.tell({"kind": "step"})
    later = until(frames, lambda f: f["state"] == "paused" and f["t"] > paused["t"])
    assert later["t"] == pytest.approx(paused["t"] + 0.05, abs=0.011)
    assert later["law"] == "still"
    session.tell({"kind": "reset"})
    back = until(frames, lambda f: f["state"] == "ready")
    np.testing.assert_allclose(back["q"], READY, rtol=0, atol=1e-5)


def test_threads_change_often_while_an_arm_is_live_and_as_usual_afterwards(live):
    """Else a busy cell would delay the arm."""
    usual = sys.getswitchinterval()
    session, frames = live({"springs": springy})
    session.tell({"kind": "go"})
    until(frames, lambda f: f["state"] == "running")
    assert sys.getswitchinterval() == pytest.approx(TURN)
    session.close()
    assert sys.getswitchinterval() == pytest.approx(usual)


def test_other_cells_are_told_while_the_arm_is_live(live):
    """One thread owns the simulator; when it ends the arm is everybody's again."""
    session, frames = live({"springs": springy})
    session.tell({"kind": "go"})
    until(frames, lambda f: f["t"] > 0.02)
    with pytest.raises(Closed, match="live in a cell"):
        lk.run(session.arm, lk.Hold(READY, 0.1), springy)
    for disturb, numbers in ((session.arm.push, np.zeros(3)), (session.arm.pull, np.zeros(7))):
        with pytest.raises(Closed, match="live in a cell"):
            disturb(numbers)
    session.close()
    lk.run(session.arm, lk.Hold(READY, 0.1), springy)


def test_walls_bands_and_targets_are_moved(live):
    """Dragging a wall into the tip pushes it; a dragged target takes the tip along; a band too."""
    far = lk.Wall(T_READY[:3, 3] + [0.3, 0.0, 0.0], (-1.0, 0.0, 0.0))
    band = lk.Spring(T_READY[:3, 3], 200.0)
    session, _ = live({"springs": springy}, things=[far, band])
    around = session.around
    around.move("thing 0", T_READY[:3, 3] - [0.015, 0.0, 0.0])
    around.move("target", T_READY[:3, 3] + [0.0, 0.1, 0.0])
    around.move("thing 1", T_READY[:3, 3] + [0.0, 0.05, 0.0])
    for _ in range(40):
        around.approach(0.005)
        session.arm.world.step(5)
    np.testing.assert_allclose(around.wanted()[:3, 3], T_READY[:3, 3] + [0.0, 0.1, 0.0])
    lk.run(session.arm, lk.Hold(READY, 1.0), springy)
    moved = session.arm.tip()[0] - T_READY[:3, 3]
    assert moved[0] < -0.003
    assert moved[1] > 0.005
    kinds = {name: thing["kind"] for name, thing in around.things().items()}
    assert kinds == {"target": "target", "thing 0": "face", "thing 1": "band"}


def test_a_model_may_be_shared_by_threads():
    """Pinocchio's work space is each thread's own: no answer is mixed up with another thread's."""
    model = lk.Model("left")
    angles = READY + np.linspace(-0.4, 0.4, 8)[:, None]
    right = [(model.mass_matrix(q), model.gravity(q)) for q in angles]
    wrong_ones = []

    def ask(k):
        for _ in range(400):
            M, g = model.mass_matrix(angles[k]), model.gravity(angles[k])
            if not (np.array_equal(M, right[k][0]) and np.array_equal(g, right[k][1])):
                wrong_ones.append(k)

    threads = [threading.Thread(target=ask, args=(k,)) for k in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert wrong_ones == []


def test_a_controller_with_memory_forgets_at_the_start_of_each_run(live):
    """Start and Reset each reset the selected one."""
    starts = []

    def law(state, target):
        return springy(state, target)

    law.reset = lambda: starts.append(1)
    session, frames = live({"law": law})
    for count, kind in enumerate(("go", "reset"), start=1):
        session.tell({"kind": kind})
        until(frames, lambda frame, count=count: len(starts) == count)


def test_what_is_given_wrongly_is_a_sentence():
    """A dial nobody reads, one without a range, a start outside it, a law that cannot be called."""
    with lk.Arm("left", q0=READY) as arm:
        hold = lk.Hold(T_READY, 1.0)
        with pytest.raises(UnknownName, match="dial"):
            lk.live(arm, hold, springy, facter=(0, 1))
        with pytest.raises(TypeMismatch, match=r"factor=\(low, high\)"):
            lk.live(arm, hold, springy, factor=3.0)
        with pytest.raises(OutOfRange, match="starts at 5"):
            lk.live(arm, hold, springy, factor=(0, 1, 5))
        with pytest.raises(TypeMismatch, match="expected a function"):
            lk.live(arm, hold, 3.0)
        with pytest.raises(TypeMismatch, match="expected a simulated"):
            lk.live("left", hold, springy)
