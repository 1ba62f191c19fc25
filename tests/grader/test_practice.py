"""The practice hand-in: from START_HERE to the page that comes back, for one point."""

from __future__ import annotations

import json
import re
import shutil

import pytest
from courses import copied
from downloaded import from_moodle
from handmade import ROOT, cell_of, put

from labkit.__main__ import main
from labkit.course import Outcome, Verdict, hand_in
from labkit.course.notebook import verdict_metadata
from labkit.grader.release import release
from labkit.grader.roster import Roster, Student, save_roster
from labkit.grader.student_zip import PICTURE, _start_here

NAME = "00_warmup"


@pytest.mark.slow
def test_one_prediction_goes_all_the_way(tmp_path, monkeypatch, capsys):
    """START_HERE names it; its receipt, the student's name and its one point come back."""
    course = copied(tmp_path / "course")
    release(course, NAME, 7)
    _start_here(course.release, [NAME], ROOT / PICTURE, None)
    start = json.loads((course.release / "START_HERE.ipynb").read_text())
    text = "\n".join("".join(cell["source"]) for cell in start["cells"])
    (link,) = re.findall(r"^1\. Open \[\w+\]\((.*?)\)", text, re.MULTILINE)
    (asked,) = re.findall(r"one point for `(\w+)`", text)

    mine = shutil.copytree(course.release / NAME, tmp_path / "ada") / f"{NAME}.ipynb"
    assert link == f"{NAME}/{mine.name}"
    notebook = put(json.loads(mine.read_text()), asked, f'{asked} = predict("{asked}", "b")')
    committed = verdict_metadata(Verdict(asked, Outcome.RIGHT, 1.0, 1.0))
    checked = {"output_type": "display_data", "data": {}, "metadata": committed}
    cell_of(notebook, asked)["outputs"] = [checked]
    mine.write_text(json.dumps(notebook))
    monkeypatch.chdir(mine.parent)
    hand_in(NAME)
    said = capsys.readouterr().out
    (receipt,) = re.findall(r"receipt: (\w{16})", said)
    last = cell_of(notebook, asked)
    last["outputs"] = [{"output_type": "stream", "name": "stdout", "text": said}]
    mine.write_text(json.dumps(notebook, indent=1))  # what JupyterLab saves afterwards

    zipped = from_moodle(
        tmp_path / "moodle.zip", [(("Ada Lovelace", 101), mine.name, mine.read_bytes())]
    )
    there = ("--course", str(course.root))
    save_roster(course, Roster((Student("ada", "Ada", "Lovelace"),)))
    assert main(["collect", NAME, str(zipped), *there]) == 0
    assert main(["grade", NAME, *there]) == 0
    assert main(["feedback", NAME, *there]) == 0
    (page,) = (course.root / "feedback").glob("*/*/*.html")
    html = page.read_text()
    assert "Ada Lovelace" in html and "1 of 11 points." in html
    assert f"<code>{receipt}</code>" in html
    section = html.partition(f'<h2 id="{asked}">')[2].partition("</section>")[0]
    assert "1 of 1 point." in section
