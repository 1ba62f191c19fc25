"""What the README shows is what happens."""

import re
import subprocess
from importlib.util import find_spec
from pathlib import Path

import labkit
from labkit.course.marking import mark
from labkit.course.messages import message
from labkit.course.student import Desk

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text()
PAGES = [
    ROOT / name
    for name in (
        "README.md",
        "CONTRIBUTING.md",
        "CHANGELOG.md",
        "ARCHITECTURE.md",
        "solutions/README.md",
        "labkit/grader/README.md",
    )
]


def test_the_example_runs_and_tracks(capsys):
    """The ten lines run as they stand and follow the circle within centimetres."""
    (code,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    names = {}
    exec(code, names)
    assert "RMS" in capsys.readouterr().out
    assert names["lk"].metrics.summary(names["log"]).max_mm < 30.0


def test_the_message_shown_is_what_the_check_says():
    """The student's answer gets the message below it, in its order; … leaves lines out."""
    (shown,) = re.findall(r"```text\n(.*?)```", README, re.DOTALL)
    code, said = shown.split("\n\n")
    names = {"lk": labkit}
    exec(code, names)
    desk = Desk.beside(ROOT / "assignments/03_velocity_control")
    question = desk.question("joint_velocity_pd")
    told = iter(str(message(question, mark(question, names[question.name]))).splitlines())
    for line in said.splitlines():
        assert line == "  …" or line in told, line


def test_what_pages_name_is_there():
    """Verbs of `make`, files that links lead to, files and modules of the project."""
    listed = subprocess.run(["make", "help"], cwd=ROOT, capture_output=True, text=True, check=True)
    verbs = set(re.findall(r"^  make (\S+)", listed.stdout, re.MULTILINE))
    wrong = []
    for page in PAGES:
        text = page.read_text().replace("NN_topic", "01_paths").replace("topic", "paths")
        wrong += [x for x in re.findall(r"`make ([a-z0-9-]+)", text) if x not in verbs]
        wrong += [x for x in re.findall(r"\]\(([^)#:]+)\)", text) if not (page.parent / x).exists()]
        places = re.findall(r"`((?:labkit|solutions|tests)/[\w./-]*)`", text)
        wrong += [x for x in places if not (ROOT / x).exists()]
        modules = re.findall(r"python -m ((?:labkit|solutions|tests)[\w.]*)", text)
        wrong += [x for x in modules if not find_spec(x)]
    assert not wrong
