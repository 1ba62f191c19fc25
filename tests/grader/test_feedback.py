"""The feedback page: a student's own runs and numbers, nothing hidden, nothing loaded, for all."""

from __future__ import annotations

import json
from base64 import b64encode
from dataclasses import replace
from hashlib import sha256
from html.parser import HTMLParser

import numpy as np
import pytest
from accessibility import violations
from made import said_by_hand, saying

import labkit as lk
from labkit.control import springs
from labkit.course import Call, Close, Loop, Question, Test
from labkit.course.judges import Number
from labkit.course.marking import mark, try_public
from labkit.course.predictions import Prediction
from labkit.course.verdict import Outcome
from labkit.grader import evidence
from labkit.grader.feedback import MEASURES, error_over_time, page
from labkit.grader.grade import _with_evidence
from labkit.grader.results import Answer, Result
from labkit.metrics import Summary
from labkit.replay.motion import unpack

pytestmark = pytest.mark.slow  # whole classes are graded

READY = lk.Model("left").robot.ready
PLANT = lk.Plant(name="ideal", armature=0.05)
EVIL = "<script>alert(1)</script><img src=x onerror=alert(1)>"
HIDDEN = 0.0987654321


def follow(state, target):
    return springs(40.0, 6.0)(state, target)


def line(share, **more):
    way = lk.Line(READY, READY + share * np.ones(7))
    return Loop(lk.Trajectory(way, lk.Quintic(1.0)), plant=PLANT, **more)


def loop_question(limit=2000.0, **more):
    public = line(0.1, expected={"max_mm": limit}, **more)
    hidden = line(HIDDEN, expected={"max_mm": 0.0123456789}, hidden=True)
    tests = (Test("it follows a line", (public, hidden), also="another line"),)
    return Question("follow", 4.0, "Follow.", Close(), tests)


def double(x):
    return 2.0 * x


HASHES = dict.fromkeys(("submission", "bundle", "engine"), "0" * 64)


def call_question():
    public = Call((np.array([1.0, 2.0, 3.0]),), expected=np.array([3.0, 4.0, 9.0]))
    hidden = Call((np.array([HIDDEN]),), expected=np.array([3.0 * HIDDEN]), hidden=True)
    tests = (Test("three times", (public, hidden), also="small numbers"),)
    return Question("double", 2.0, "Triple.", Close(), tests)


def answered(question, function):
    tried = try_public(question, function)
    verdict = mark(question, function, tried)
    return _with_evidence(Answer(verdict, source="def f(): 1"), question, tried)


@pytest.fixture(scope="module")
def result():
    """A run that fails by a hidden case, numbers that are wrong, a run that is right."""
    right = replace(loop_question(), tests=loop_question().public().tests, name="again")
    asked = ((loop_question(), follow), (call_question(), double), (right, follow))
    questions = tuple(answered(question, function) for question, function in asked)
    return Result("09_demo", "ada", 4.0, 10.0, 1, HASHES, questions=questions)


class Page(HTMLParser):
    """Elements, texts, and what stands in scripts and styles."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.tags, self.words, self.code = [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def handle_data(self, data):
        if self.cdata_elem:
            self.code.append((self.cdata_elem, self.tags[-1][1], data))
        else:
            self.words.append(data)

    @property
    def policy(self):
        """The content security policy, rule by rule."""
        (text,) = (a["content"] for t, a in self.tags if t == "meta" and "http-equiv" in a)
        return {rule.split()[0]: rule.split()[1:] for rule in text.split("; ")}


def test_each_run_is_kept_small_and_whole(result):
    """A public run is in the result: measures as the checker took them, its motion within 60 kB."""
    (run,) = result.questions[0].runs
    question = loop_question()
    case = question.tests[0].cases[0]
    log = case.ask(follow)
    assert run["measures"]["rms_mm"] == pytest.approx(case.measured(log)["rms_mm"], rel=1e-5)
    assert len(run["motion"]) < evidence.MAX_BYTES
    motion = json.loads(run["motion"])
    figure, words = error_over_time(run, motion)
    assert f'aria-label="{words}"' in figure and figure.count(",") > 20 and "2000 mm" in words
    q = unpack(motion["q"])
    assert np.abs(q[-1] - log.q[-1]).max() <= 1e-4
    assert Result.read(result.text()).questions[0].runs == (run,)
    assert set(MEASURES) == set(Summary.__dataclass_fields__), "each measure has a name"


def test_an_arm_that_ran_away_is_shown_up_to_then():
    """A damper with the wrong sign loses the arm; its motion up to then has finite numbers."""

    def away(state, target):
        return lk.JointTorque(10.0 * (target.position - state.q) + 50.0 * state.dq)

    found = answered(loop_question(q0=READY + 0.05), away)
    (run,) = found.runs
    assert found.verdict.outcome is Outcome.ERROR
    assert not run["complete"]
    assert not run["measures"]
    assert len(unpack(json.loads(run["motion"])["q"])) >= evidence.MIN_SAMPLES
    text = page(Result("09_demo", "ada", 0.0, 4.0, 1, HASHES, questions=(found,)))
    assert "It ran away; this is what it did up to then." in text


def test_numbers_beside_those_expected(result):
    """Where a formula is wrong on a public input, its numbers stand beside those expected."""
    found = result.questions[1].numbers
    assert found == {"call": "double([1, 2, 3])", "expected": [3.0, 4.0, 9.0],
                     "given": [2.0, 4.0, 6.0], "of": 3}  # fmt: skip
    assert "Of 3 numbers, number 3 is farthest off: expected 9, returned 6." in page(result)
    assert answered(replace(call_question(), judge=Close(rtol=10.0)), double).numbers is None


def test_nothing_hidden_is_in_the_page(result):
    """No number of a hidden case stands in result or page; only what class of case failed."""
    text = page(result)
    for secret in (f"{HIDDEN:.5f}", f"{3 * HIDDEN:.5f}", f"{2 * HIDDEN:.5f}", "0.01234"):
        assert secret not in text
        assert secret not in result.text()
    assert "a hidden case (another line)" in text
    for question in result.questions:
        assert {run["test"] for run in question.runs} <= {"it follows a line"}
    motion = json.loads(result.questions[0].runs[0]["motion"])
    asked = READY + 0.1
    assert np.abs(unpack(motion["ghosts"]["the target"])[-1] - asked).max() < 1e-3


def test_a_prediction_is_committed_and_not_called_right(result):
    """Whatever it says; and it is not counted among the answers that are right."""
    asked = Prediction("guess", "How far?", Number("mm", 0.0, 9.0), truth=3.0).question()
    text = page(replace(result, questions=(*result.questions, answered(asked, lambda: 7.0))))
    words = " ".join(" ".join(Page(text).words).split())
    assert "1 of 3 answers that tests check are right. 1 of 1 predictions were committed;" in words
    assert words.count("Right.") == 1 and "Committed." in words


def test_policy_names_each_script_and_nothing_else(result):
    """Scripts and style run by their hash alone; no network, no frames, no inline handlers."""
    found = Page(page(result))
    assert found.policy["default-src"] == ["'none'"]
    assert found.policy["base-uri"] == found.policy["form-action"] == ["'none'"]
    assert set(found.policy) == {
        "default-src",
        "base-uri",
        "form-action",
        "style-src",
        "script-src",
    }
    for tag, rule in (("script", "script-src"), ("style", "style-src")):
        codes = [c for t, a, c in found.code if t == tag and a.get("type") != "application/json"]
        hashes = [f"'sha256-{b64encode(sha256(c.encode()).digest()).decode()}'" for c in codes]
        assert hashes == found.policy[rule]
    assert not [a for _, a in found.tags if any(k.startswith("on") or k == "style" for k in a)]
    assert not [a for _, a in found.tags if "src" in a or not a.get("href", "#").startswith("#")]


def test_viewer_comes_once_and_only_where_it_is_needed(result):
    """Two replays share one viewer; a page without a run has no script at all."""
    text = page(result)
    assert text.count('class="lk-embed"') == 2
    assert text.count("labkitRobot=") == 1
    assert 1.2e6 < len(text.encode()) < 1.6e6
    plain = page(replace(result, questions=result.questions[1:2]))
    assert len(plain.encode()) < 20_000
    assert "<script" not in plain
    assert "script-src" not in plain


def test_whatever_a_student_says_is_text(result):
    """Their name, their code, their exception's words: text, wherever they come from."""
    worst = replace(
        result,
        student=EVIL,
        notes=(EVIL,),
        questions=tuple(
            replace(q, source=EVIL, notes=(EVIL,), verdict=saying(q.verdict, EVIL),
                    numbers=q.numbers and q.numbers | {"call": EVIL},
                    runs=tuple(r | {"says": EVIL, "words": EVIL} for r in q.runs))
            for q in result.questions
        ),
    )  # fmt: skip
    found = Page(page(worst, said_by_hand(worst, follow=EVIL)))
    assert not {"img", "iframe", "object", "link"} & {tag for tag, _ in found.tags}
    leads = {a["href"] for tag, a in found.tags if tag == "a"}
    assert leads == {f"#{q.verdict.name}" for q in worst.questions}
    assert sum(tag == "script" for tag, _ in found.tags) == 3 + 2
    assert sum(EVIL in words for words in found.words) >= 10


@pytest.fixture
def visit(result, tmp_path):
    """Open the page from the disk; at the end no request went out and nothing complained."""
    path, seen_, contexts = tmp_path / "page.html", [], []
    path.write_text(page(result))

    def go(browser, *, width=1100, **options):
        context = browser.new_context(
            viewport={"width": width, "height": 900}, reduced_motion="reduce", **options
        )
        contexts.append(context)
        opened = context.new_page()
        opened.on("console", lambda m: m.type in ("error", "warning") and seen_.append(m.text))
        opened.on("pageerror", lambda e: seen_.append(str(e)))
        opened.on("request", lambda r: seen_.append(r.url) if r.url != path.as_uri() else 0)
        opened.goto(path.as_uri())
        return opened

    yield go
    for context in contexts:
        context.close()
    assert [x for x in seen_ if "GPU stall" not in x] == []


def wake(opened):
    """Bring every replay into sight and open all that folds."""
    opened.evaluate("""async () => {
        const soon = () => new Promise((r) => setTimeout(r, 30));
        for (const e of document.querySelectorAll('.lk-embed')) {
            e.scrollIntoView();
            while (!e.querySelector('[data-ready]')) await soon();
        }
        for (const e of document.querySelectorAll('details')) e.open = true;
    }""")


@pytest.mark.parametrize(("scheme", "width"), [("light", 1100), ("dark", 390)])
def test_page_is_for_everybody(chromium, visit, scheme, width):
    """Nothing for axe-core to find in light, in dark and on a phone, where nothing is too wide."""
    opened = visit(chromium, color_scheme=scheme, width=width)
    wake(opened)
    assert opened.evaluate("document.documentElement.dataset.theme") == scheme
    assert opened.evaluate("document.documentElement.scrollWidth") <= width
    assert violations(opened) == []


def test_page_is_readable_without_scripts(chromium, visit):
    """Without scripts verdict, figure, measures and the motion in words are there."""
    opened = visit(chromium, java_script_enabled=False)
    words = opened.inner_text("main")
    for part in ("4 of 10 points", "position error of the tip, RMS", "Baxter's left arm moves"):
        assert part in words
    assert opened.locator("svg[role=img]").count() == 2
