"""Two engines, one campaign: what counts as the same."""

import copy
import json
import sys

import pytest

from labkit.errors import LabkitError
from solutions.study import both_engines
from solutions.study.both_engines import agreement, differences


def found():
    """A campaign of one claim and one run."""
    seeds = {"of": "line", "mean": 1.0, "half_width": 0.2, "units": 5, "outcome": "held"}
    tasks = {"of": "tasks", "mean": 1.0, "half_width": 5.0, "units": 3, "outcome": "undecided"}
    row = {
        "plant": "baxter",
        "task": "line",
        "controller": "joint torque",
        "seed": 0,
        "failed": None,
    }
    return {
        "verdicts": [{"claim": "a beats b", "unit": "mm", "overall": tasks, "tasks": [seeds]}],
        "rows": [row | {"late_rms_mm": 4.0, "late_max_mm": 9.0}],
    }


@pytest.mark.parametrize(
    ("change", "count"),
    [
        (lambda x: None, 0),
        (lambda x: x["rows"][0].update(late_rms_mm=4.15), 0),  # within 5 %
        (lambda x: x["rows"][0].update(late_rms_mm=4.3), 1),
        (lambda x: x["rows"][0].update(failed="diverged"), 2),
        (lambda x: x["verdicts"][0]["tasks"][0].update(outcome="undecided"), 1),
        (lambda x: x["verdicts"][0]["overall"].update(mean=-1.0), 1),
        (lambda x: x["verdicts"][0]["overall"].update(mean=1.09), 0),  # within 0.1 mm
        (lambda x: x["rows"].clear(), 2),
    ],
)
def test_engines_agree_to_five_per_cent_or_a_tenth_of_a_millimetre(change, count):
    """And every verdict is the same word; a run that is missing or failed is a difference."""
    other = copy.deepcopy(found())
    change(other)
    assert len(list(differences(found(), other))) == count


def test_the_book_is_told_how_far_the_engines_are_apart():
    """It receives the claims, those that agree, the runs, and the largest difference in mm."""
    other = copy.deepcopy(found())
    other["rows"][0]["late_max_mm"] += 0.25
    other["verdicts"][0]["overall"]["outcome"] = "held"
    told = agreement(found(), other)
    assert told == {"claims": 1, "alike": 0, "runs": 1, "farthest_mm": pytest.approx(0.25)}


def test_every_engine_that_is_installed_is_compared_with_the_first(tmp_path, monkeypatch, capsys):
    """Of three engines the third is the farthest, and the book receives its distance."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(both_engines, "installed", lambda: ["one", "two", "three"])
    monkeypatch.setattr(both_engines, "KEPT", tmp_path / "engines.json")
    monkeypatch.setattr(sys, "argv", ["both_engines", "--compare"])
    for name, off in {"one": 0.0, "two": 0.05, "three": 7.0}.items():
        campaign = found()
        campaign["rows"][0]["late_rms_mm"] += off
        (tmp_path / "build" / name).mkdir(parents=True)
        (tmp_path / "build" / name / "campaign.json").write_text(json.dumps(campaign))
    assert both_engines.main() == 1
    said = capsys.readouterr().out
    assert "one and three: " in said and "one and two: " not in said
    assert json.loads((tmp_path / "engines.json").read_text())["farthest_mm"] == 7.0


def test_one_engine_alone_is_compared_with_nothing(monkeypatch):
    """The other's name is said, and how it is installed."""
    monkeypatch.setattr(both_engines, "installed", lambda: ["mujoco"])
    with pytest.raises(LabkitError, match="needs two; type: pip install pybullet"):
        both_engines.engines()
