"""Tools of the replay tests, which run the viewer's sources in node."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
SOURCES = ROOT / "labkit/replay/viewer"


@pytest.fixture(scope="session")
def node():
    """A function that evaluates an expression with the viewer's modules and an input `x`."""
    assert shutil.which("node"), "node is missing: apt-get install nodejs (version 20 or newer)"

    def evaluate(expression: str, x=None):
        names = ("so3", "kinematics", "scaling", "recording")
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
            input=json.dumps(x), capture_output=True, text=True, timeout=600, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    return evaluate
