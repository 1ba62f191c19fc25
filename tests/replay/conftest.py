"""Tools of the replay tests: node on the viewer's sources, Chromium on a page from the disk."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest
from playwright.sync_api import sync_playwright

ROOT = Path(__file__).parents[2]
SOURCES = ROOT / "labkit/replay/viewer"
CHROMIUM = "/usr/bin/chromium"
ARGUMENTS = [
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
]  # fmt: skip


@pytest.fixture(scope="session")
def node():
    """Call with an expression and an input: evaluates it on the viewer's modules, `x` the input."""
    assert shutil.which("node"), "node is missing: apt-get install nodejs (version 20 or newer)"

    def evaluate(expression: str, x=None):
        names = ("so3", "kinematics", "scaling", "recording", "rotation_demo", "grid")
        imports = "\n".join(
            f"import * as {n} from {json.dumps((SOURCES / f'{n}.js').as_uri())};"
            for n in names
            if f"{n}." in expression
        )
        robot = json.dumps((ROOT / "labkit/data/viewer/robot.js").as_uri())
        program = f"""{imports}
            import {{ readFileSync }} from "node:fs";
            await import({robot});
            const robot = globalThis.labkitRobot;
            const x = JSON.parse(readFileSync(0, "utf8"));
            console.log(JSON.stringify({expression}));"""
        done = subprocess.run(
            ["node", "--input-type=module", "-e", program],
            input=json.dumps(x), capture_output=True, text=True, timeout=60, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    return evaluate


@pytest.fixture(scope="session")
def playwright():
    """Playwright's driver."""
    with sync_playwright() as driver:
        yield driver


@pytest.fixture(scope="session")
def chromium(playwright):
    """Debian's Chromium, with WebGL in software."""
    assert Path(CHROMIUM).exists(), "Chromium is missing: apt-get install chromium"
    flags = [*ARGUMENTS, "--enable-unsafe-swiftshader"]
    browser = playwright.chromium.launch(executable_path=CHROMIUM, args=flags)
    yield browser
    browser.close()


@pytest.fixture(scope="session")
def blind_chromium(playwright):
    """The same without WebGL."""
    flags = [*ARGUMENTS, "--disable-3d-apis"]
    browser = playwright.chromium.launch(executable_path=CHROMIUM, args=flags)
    yield browser
    browser.close()
