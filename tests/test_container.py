"""The students' container holds no answers, and starting it writes over no work."""

import os
import re
import subprocess
from pathlib import Path

ROOT = Path(__file__).parents[1]


def test_a_students_image_is_made_from_the_handout_alone_and_is_no_roots():
    """The last stage copies what students get, and nothing else."""
    last = (ROOT / "Dockerfile").read_text().rpartition("\nFROM ")[2]
    (copied,) = re.findall(r"^(?:COPY|ADD) (.*)$", last, flags=re.MULTILINE)
    words = "--from=course /handout/baxter-lab /lab/.ci/start_container.sh /opt/baxter-lab/"
    assert copied == words
    assert re.findall(r"^USER (.*)$", last, flags=re.MULTILINE) == ["jovyan"]


def test_a_new_home_gets_the_notebooks_and_an_old_one_keeps_its_work(tmp_path):
    """What a student wrote is never written over; a folder that is missing comes."""
    lab, home = tmp_path / "lab", tmp_path / "home"
    for name in ("00_warmup", "01_paths"):
        (lab / "assignments" / name).mkdir(parents=True)
        (lab / "assignments" / name / "it.ipynb").write_text("released")
    (lab / "start.sh").write_text((ROOT / ".ci/start_container.sh").read_text())
    own, other = (home / "assignments" / name / "it.ipynb" for name in ("00_warmup", "01_paths"))
    own.parent.mkdir(parents=True)
    own.write_text("mine")
    environment = {"PATH": os.environ["PATH"], "HOME": str(home)}
    subprocess.run(["sh", str(lab / "start.sh"), "true"], env=environment, check=True)
    assert (own.read_text(), other.read_text()) == ("mine", "released")
