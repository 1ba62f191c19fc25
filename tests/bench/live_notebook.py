"""The live arm in JupyterLab, pulled by a mouse.

`python -m tests.bench.live_notebook FOLDER` pulls arms with wrong laws and saves a picture of each.
"""

import os
import secrets
import socket
import statistics
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path

import nbformat

ROOT = Path(__file__).parents[2]
FLAGS = ["--no-sandbox", "--enable-unsafe-swiftshader"]
SECONDS, DRAGS = 5.0, 5
PULL = 5.0  # smallest force that counts as a pull, in [N]
LIVE = "document.querySelector('.lk-live').parentElement.labkit"

ARM = """
import sys, threading, time
import numpy as np
import labkit as lk
from solutions.impedance.answers import workspace_impedance

PLANT = lk.Plant(name="textbook", armature=0.05, viscous=0.7)
model = lk.Model("left", PLANT)
ready = model.robot.ready
T = model.pose(ready)
K = np.array([300.0] * 3 + [20.0] * 3)
D = 2.0 * np.sqrt(K * np.diag(model.operational_inertia(ready)))


def right(state, target, stiffness):
    return workspace_impedance(state, target, model, stiffness=np.r_[[stiffness] * 3, K[3:]],
                               damping=D)


def wrong_sign(state, target):
    return workspace_impedance(state, target, model, stiffness=-K, damping=D)


def tool_axes(state, target):
    R = model.pose(state.q)[:3, :3]
    e, J = lk.se3.pose_error(target.pose, model.pose(state.q)), model.tip_jacobian(state.q)
    e = np.r_[R.T @ e[:3], R.T @ e[3:]]
    c, g = model.coriolis(state.q, state.dq) @ state.dq, model.gravity(state.q)
    return lk.JointTorque(J.T @ (K * e - D * (J @ state.dq)) + c + g)


def no_gravity(state, target):
    return lk.JointTorque(right(state, target, 300.0).value - model.gravity(state.q))


def raises(state, target):
    return lk.JointTorque(target.q)


def diverges(state, target):
    return lk.JointTorque(40.0 * (state.q - ready) + 30.0 * state.dq + model.gravity(state.q))


def too_slow(state, target):
    time.sleep(0.02)
    return right(state, target, 300.0)


def loops(state, target):
    while True:
        pass


laws = [right, wrong_sign, tool_axes, no_gravity, raises, diverges, too_slow, loops]
wall = lk.Wall(T[:3, 3] + [0.1, 0.0, 0.0], (-1.0, 0.0, 0.0), size=(0.3, 0.3))
band = lk.Spring(T[:3, 3] + [0.0, 0.25, 0.0], 20.0)
arm = lk.Arm("left", PLANT, q0=ready, world=lk.World(things=[wall, band]))
view = lk.live(arm, lk.Hold(T, 2.0), {law.__name__: law for law in laws},
               stiffness=(50.0, 1500.0, 300.0), payload=(0.0, 1.0))
view
"""
BUSY = """
session = view.session
while session._hand.at is not None:
    held = session._hand.heard
    sum(range(1000))
    if session._hand.at is None:
        print("let go after", 1000 * (time.monotonic() - held), "ms")
"""
TIP = """() => {
    const { stage, tip } = LIVE.picture, box = stage.canvas.getBoundingClientRect();
    const p = stage.camera.position.clone().set(...tip.p).project(stage.camera);
    return [box.x + (p.x + 1) * box.width / 2, box.y + (1 - p.y) * box.height / 2];
}""".replace("LIVE", LIVE)
RECORD = """() => {
    const live = LIVE, show = live.show.bind(live);
    live.seen = [];
    live.show = (f) => {
        show(f);
        live.seen.push([performance.now(), f.t, f.force ? Math.hypot(...f.force) : 0, live.frames,
            live.note.textContent]);
    };
    window.addEventListener("pointermove", (e) => { live.moved ??= e.timeStamp; }, true);
}""".replace("LIVE", LIVE)


@contextmanager
def notebook(*cells):
    """A page of JupyterLab with an open notebook that has been run from the top."""
    from chromium import program
    from playwright.sync_api import sync_playwright

    with tempfile.TemporaryDirectory() as place, socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port, token = free.getsockname()[1], secrets.token_hex(16)
        free.close()
        kernel = {"name": "python3", "display_name": "Python 3", "language": "python"}
        made = nbformat.v4.new_notebook(metadata={"kernelspec": kernel})
        made.cells = [nbformat.v4.new_code_cell(text.strip()) for text in cells]
        nbformat.write(made, f"{place}/live.ipynb")
        own = {"JUPYTER_CONFIG_DIR": f"{place}/config", "JUPYTER_RUNTIME_DIR": f"{place}/runtime"}
        path = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
        command = [
            sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root",
            "--ip=127.0.0.1", f"--port={port}", f"--IdentityProvider.token={token}",
            f"--ServerApp.root_dir={place}", "--LabApp.expose_app_in_browser=True",
            "--KernelManager.transport=ipc", "--LabApp.news_url=None",
        ]  # fmt: skip
        with Path(place, "log").open("w") as log:
            server = subprocess.Popen(
                command,
                env=os.environ | own | {"PYTHONPATH": path},
                cwd=place,
                stdout=log,
                stderr=log,
            )
        try:
            answers(port, server, Path(place, "log"))
            with sync_playwright() as playwright:
                browser = playwright.chromium.launch(executable_path=program(), args=FLAGS)
                page = browser.new_page(viewport={"width": 1280, "height": 1200})
                page.set_default_timeout(45_000)
                page.goto(f"http://127.0.0.1:{port}/lab/tree/live.ipynb?token={token}")
                page.wait_for_selector(".jp-Notebook .jp-CodeCell")
                page.wait_for_function(
                    "window.jupyterapp?.shell.currentWidget?.sessionContext?.isReady"
                )
                execute(page, "notebook:run-all-cells")
                page.wait_for_selector("[data-ready] .lk-live canvas")
                page.locator(".lk-live .lk-stage").scroll_into_view_if_needed()
                page.evaluate(RECORD)
                page.locator(".lk-live .lk-play").click()
                page.wait_for_function(f"{LIVE}.state === 'running' && {LIVE}.frame.t > 0.5")
                yield page
                browser.close()
        finally:
            server.terminate()
            server.wait(30)


def answers(port, server, log, patience=240.0):
    """Wait until the server listens."""
    end = time.monotonic() + patience
    while server.poll() is None and time.monotonic() < end:
        with socket.socket() as probe:
            if probe.connect_ex(("127.0.0.1", port)) == 0:
                return
        time.sleep(0.2)
    raise RuntimeError(f"JupyterLab did not start: {log.read_text()[-1000:]}")


def execute(page, command, cell=None):
    """Execute a command of JupyterLab on a cell."""
    page.evaluate(
        """([command, cell]) => {
            if (cell !== null) jupyterapp.shell.currentWidget.content.activeCellIndex = cell;
            jupyterapp.commands.execute(command);
        }""",
        [command, cell],
    )


def press(page):
    """Take hold of the tip with the mouse; return its position, in [px]."""
    x, y = page.evaluate(TIP)
    page.mouse.move(x, y)
    page.mouse.down()
    return x, y


def seen(page, since=0):
    """The drawn frames: rows of wall clock [ms], the arm's time [s], force [N], picture count."""
    return page.evaluate(f"{LIVE}.seen.slice({since})")


def a_second(rows, column):
    """The growth of a number of `seen` per second of the wall clock."""
    (first, *_, last) = rows
    return 1000 * (last[column] - first[column]) / (last[0] - first[0])


def latency(page):
    """Milliseconds from the first move of the mouse to the first force that the page shows."""
    x, y = press(page)
    page.wait_for_function(f"{LIVE}.seen.length && {LIVE}.seen.at(-1)[2] < 1")
    page.evaluate(f"{LIVE}.moved = null; {LIVE}.seen = []")
    page.mouse.move(x + 50, y)
    page.wait_for_function(f"{LIVE}.seen.some(([,, force]) => force > {PULL})")
    page.mouse.up()
    first = next(row for row in seen(page) if row[2] > PULL)
    page.wait_for_timeout(1500)
    return first[0] - page.evaluate(f"{LIVE}.moved")


def measure():
    """The live arm in JupyterLab: real-time factor, pictures per second, ms from drag to force.

    The last one is the median of several drags; `seen` and `BUSY` explain the other keys.
    """
    with notebook(ARM, "pass", BUSY) as page:
        page.evaluate(f"{LIVE}.seen = []")
        page.wait_for_timeout(1000 * SECONDS)
        free = seen(page)
        late = [latency(page) for _ in range(DRAGS)]
        x, y = press(page)
        page.mouse.move(x + 50, y)
        page.wait_for_function(f"{LIVE}.frame.force && Math.hypot(...{LIVE}.frame.force) > 1")
        execute(page, "notebook:run-cell", 2)
        page.wait_for_timeout(500)
        page.evaluate(f"{LIVE}.seen = []")
        page.wait_for_timeout(2000)
        busy = seen(page)
        page.evaluate(f"{LIVE}.send = () => {{}}")  # from here on the kernel receives nothing
        said = page.locator(".jp-OutputArea-output", has_text="let go after")
        said.wait_for()
        let_go = float(said.inner_text().split()[3])
        page.locator(".lk-live .lk-say", has_text="busy with another cell").wait_for()
        page.mouse.up()
    return {
        "live_notebook_pace": a_second(free, 1),
        "live_notebook_pictures_hz": a_second(free, 3),
        "live_latency_ms": statistics.median(late),
        "live_busy_pace": a_second(busy, 1),
        "live_busy_pictures_hz": a_second(busy, 3),
        "live_let_go_ms": let_go,
    }


def feel(folder):
    """Pull the arm under each wrong law with the mouse; print its state and save a picture."""
    with notebook(ARM) as page:
        for law in page.get_by_label("Controller").locator("option").all_inner_texts():
            start, note = page.locator(".lk-live .lk-play"), page.locator(".lk-live .lk-say")
            page.get_by_role("button", name="Reset", exact=True).click()
            page.get_by_label("Controller").select_option(law)
            if start.inner_text() == "Start":
                start.click()
            page.wait_for_function(f"{LIVE}.frame.law === '{law}' && {LIVE}.state !== 'ready'")
            if page.evaluate(f"{LIVE}.state") == "running":
                x, y = press(page)
                page.mouse.move(x + 60, y - 15)
            page.wait_for_timeout(1500)
            page.screenshot(path=Path(folder) / f"{law}.png")
            page.mouse.up()
            page.wait_for_timeout(2500)
            page.screenshot(path=Path(folder) / f"{law}, let go.png")
            told = page.evaluate(f"[{LIVE}.state, {LIVE}.readout.textContent]")
            print(law, *told, note.inner_text() if note.is_visible() else "", sep=" | ", flush=True)


if __name__ == "__main__":
    sys.path += [str(ROOT / "book/_tools")]
    feel(sys.argv[1])
