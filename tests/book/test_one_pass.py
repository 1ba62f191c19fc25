"""What a program earns that answers everything in one pass: the guide says the recorded number."""

import json

from book_pages import ROOT

OWN_ARM = {"my_lag", "my_payload", "my_wall", "bug_1", "bug_2", "bug_3", "experiment"}
WEIGHTS = {"functions": 30.0, "predictions and whys": 10.0, "own arm": 10.0, "report": 30.0}
"""In percent, as the guide recommends them; 20 more are for the defence."""
WHYS = 14.0, 16.0
"""Eight whys of two points: six are not drawn and count in full, two are half right (estimated)."""
REPORT = 2.0, 20.0
"""Two predictions; with neither a figure nor numbers of one's own arm no row earns anything."""


def earned_by_a_program():
    """Points earned and points by what they are for, from the grader's marks of the one pass."""
    done = json.loads((ROOT / "solutions/study/one_pass.json").read_text())
    sums = dict.fromkeys(WEIGHTS, (0.0, 0.0)) | {"predictions and whys": WHYS, "report": REPORT}
    accepted = []
    for name, said in ((n, said) for answers in done.values() for n, said in answers.items()):
        function = said["answer"].startswith("def ")
        part = "own arm" if name in OWN_ARM else "functions" if function else "predictions and whys"
        sums[part] = (sums[part][0] + said["earned"], sums[part][1] + said["points"])
        accepted += [said["earned"] == said["points"]] if function else []
    return sums, accepted


def test_the_guide_says_what_a_program_earns():
    """The share of the mark, its parts, and the functions accepted are the recorded ones."""
    sums, accepted = earned_by_a_program()
    guide = " ".join((ROOT / "book/instructor_guide.md").read_text().split())
    share = {part: WEIGHTS[part] * got / full for part, (got, full) in sums.items()}
    assert f"a program alone earns about {sum(share.values()):.0f} % of the mark" in guide
    assert f"accepted {sum(accepted)} of {len(accepted)} functions" in guide
    assert f"({share['functions']:.1f} of 30 %)" in guide
    assert f"Of the {sums['own arm'][1]:.0f} points for the student's own arm" in guide
    assert f"guesses earned {sums['own arm'][0]:.0f} ({share['own arm']:.1f} of 10 %)" in guide
    assert f"earn {share['predictions and whys']:.1f} of 10 %" in guide
    assert f"({share['report']:.1f} of 30 %)" in guide
    assert sum(share.values()) <= 45.0


def test_the_one_pass_answered_every_question_of_the_notebooks():
    """Nobody added a question that the program was not asked."""
    done = json.loads((ROOT / "solutions/study/one_pass.json").read_text())
    for name, answers in done.items():
        cells = json.loads((ROOT / f"assignments/{name}/{name}.ipynb").read_text())["cells"]
        marks = [cell["metadata"].get("nbgrader", {}) for cell in cells]
        asked = {m["grade_id"].removesuffix("-check") for m in marks if m.get("points")}
        whys = {m["grade_id"] for m in marks if m.get("points") and m["solution"]}
        assert asked - whys == set(answers), name
