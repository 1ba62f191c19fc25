"""What is recorded of the known answers is what they earn, and a change is named."""

import json

from solutions.study import record


def test_the_known_answers_earn_what_is_recorded():
    """Nobody's physics or questions moved without `make record`."""
    assert record.main(["--check", "00_warmup"]) == 0


def test_a_verdict_that_changed_is_named_with_its_reason(tmp_path, monkeypatch, capsys):
    """The answer, what it earned before and now, and the test that turned."""
    rows = json.loads(record.VERDICTS.read_text())
    key = next(key for key in rows if key.startswith("00_warmup") and key.endswith("the answer"))
    name = rows[key]["tests"][0][0]
    rows[key]["tests"][0][1] = "wrong"
    rows[key]["earned"] = 0.25
    monkeypatch.setattr(record, "VERDICTS", tmp_path / "verdicts.json")
    record.VERDICTS.write_text(json.dumps(rows))
    assert record.main(["--check", "00_warmup"]) == 1
    said = capsys.readouterr().out
    assert f"{key}: 0.25 points before" in said
    assert f"{name}: wrong before, right now" in said


def test_an_answer_that_is_no_longer_asked_leaves_the_record(tmp_path, monkeypatch):
    """Recording one notebook drops its renamed answers and keeps the other notebooks' rows."""
    rows = json.loads(record.VERDICTS.read_text())
    monkeypatch.setattr(record, "VERDICTS", tmp_path / "verdicts.json")
    row = {"earned": 0.0, "tests": [], "mistake": None}
    stale = {"00_warmup/joint_error/an old name": row}
    record.VERDICTS.write_text(json.dumps({**rows, **stale}))
    assert record.main(["--verdicts", "00_warmup"]) == 0
    assert json.loads(record.VERDICTS.read_text()) == rows
