"""The embed in Debian's Chromium, opened from the disk as a reader would."""

import shutil
from pathlib import Path

import pytest
from accessibility import violations
from figures.embed import (
    demo_html,
    motion_html,
    shared_files,
)
from samples import swing

ROOT = Path(__file__).parents[2]
POLICY = "default-src 'none'; script-src file:; img-src file: data:; style-src file:"
PAGE = """<!doctype html><html lang="en" data-theme="light"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1"><title>Replay</title>
<meta http-equiv="Content-Security-Policy" content="{policy}">
<link rel="stylesheet" href="page.css"></head>
<body><main><h1>Replay</h1>{body}</main></body></html>"""
CSS = """body { margin: 1rem auto; max-width: 50rem; padding: 0 1rem }
body { background: #fff; color: #222 }
html[data-theme=dark] body { background: #14181e; color: #ddd } figure { margin: 1rem 0 }"""


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """A folder of pages with one shared viewer."""
    folder = tmp_path_factory.mktemp("site")
    static = folder / "viewer"
    static.mkdir()
    for name, path in shared_files().items():
        shutil.copy(path, static / name)
    bodies = {
        "motion": motion_html(swing(), root="viewer/"),
        "several": "".join(motion_html(swing(3.0, side=s), root="viewer/")
                           for s in ("left", "right", "left", "right")),
        "demos": "".join(demo_html(n, root="viewer/") for n in ("jacobian", "rotation")),
    }  # fmt: skip
    for name, body in bodies.items():
        (folder / f"{name}.html").write_text(PAGE.format(policy=POLICY, body=body))
    (folder / "page.css").write_text(CSS)
    return folder


@pytest.fixture
def visit(pages):
    """Open a page; at the end no request went out and no error was logged."""
    seen, contexts = [], []

    def go(browser, name, *, phone=False, theme="light", **options):
        size = {"width": 390, "height": 844} if phone else {"width": 1000, "height": 900}
        context = browser.new_context(viewport=size, **options)
        contexts.append(context)
        page = context.new_page()
        page.on("console", lambda m: m.type == "error" and seen.append(m.text))
        page.on("pageerror", lambda e: seen.append(str(e)))
        own = ("file:", "data:", "blob:")
        page.on("request", lambda r: r.url.startswith(own) or seen.append(r.url))
        page.goto((pages / f"{name}.html").as_uri())
        page.evaluate(f"document.documentElement.dataset.theme = '{theme}'")
        return page

    yield go
    for context in contexts:
        context.close()
    assert seen == []


def test_the_keyboard_moves_time_and_pose(chromium, visit):
    """Ten arrows are 0.4 s and another pose; a typed 2.5 s is shown and said to a screen reader."""
    page = visit(chromium, "motion")
    page.wait_for_selector("[data-ready]")
    wrist = "document.querySelector('[data-ready]').labkit.picture.frames.left_w2.p[1]"
    before = page.evaluate(wrist)
    page.get_by_role("slider", name="Time").focus()
    for _ in range(10):
        page.keyboard.press("ArrowRight")
    assert abs(page.evaluate(wrist) - before) > 0.003
    assert "t = 0.40 s" in page.inner_text(".lk-readout")
    page.get_by_text("More").click()
    typed = page.get_by_label("Time in seconds, typed")
    typed.fill("2.5")
    typed.press("Enter")
    assert "t = 2.50 s" in page.inner_text(".lk-readout")
    page.locator("[role=status]").filter(has_text="2.50").wait_for(state="attached")
    cursors = page.eval_on_selector_all(".lk-cursor", "all => all.map(c => +c.getAttribute('x1'))")
    assert len(cursors) == 2


def test_arrow_keys_turn_the_view(chromium, visit):
    """The left arrow turns it, plus comes nearer, and 4 is the view from the top."""
    page = visit(chromium, "motion")
    page.wait_for_selector("[data-ready]")
    page.focus("canvas")
    rig = "document.querySelector('[data-ready]').labkit.stage.rig"
    azimuth, distance = page.evaluate(f"[{rig}.azimuth, {rig}.distance]")
    page.keyboard.press("ArrowLeft")
    page.keyboard.press("+")
    turned, nearer = page.evaluate(f"[{rig}.azimuth, {rig}.distance]")
    assert turned != azimuth
    assert nearer < distance
    page.keyboard.press("4")
    assert page.evaluate(f"{rig}.view") == "Top"


@pytest.mark.parametrize("reduced", ["no-preference", "reduce"])
def test_play_waits_for_the_reader_and_honours_reduced_motion(chromium, visit, reduced):
    """Time is zero until Play; with reduced motion there are four pictures a second at most."""
    page = visit(chromium, "motion", reduced_motion=reduced)
    page.wait_for_selector("[data-ready]")
    page.wait_for_timeout(300)
    assert "t = 0.00 s" in page.inner_text(".lk-readout"), "nothing moves by itself"
    page.evaluate("""() => {
        window.steps = [];
        const readout = document.querySelector('.lk-readout');
        new MutationObserver(() => steps.push(performance.now()))
            .observe(readout, {childList: true});
    }""")
    page.get_by_role("button", name="Play").click()
    page.wait_for_function("() => steps.length > 4")  # it plays
    page.get_by_role("button", name="Pause").click()
    steps = page.evaluate("steps")
    if reduced == "reduce":  # still pictures, at most four a second
        assert len(steps) <= 4 * (steps[-1] - steps[0]) / 1000 + 2


def test_without_webgl_words_plots_and_slider_remain(blind_chromium, visit):
    """The description and more than seven curves are there, and Page Up moves to 1 s."""
    seen = visit(blind_chromium, "motion")
    seen.wait_for_selector("[data-ready]")
    assert seen.is_visible(".lk-alt")
    assert "WebGL is missing" in seen.inner_text(".lk-note")
    seen.get_by_role("slider", name="Time").focus()
    seen.keyboard.press("PageUp")
    assert "t = 1.00 s" in seen.inner_text(".lk-readout")
    seen.wait_for_function("document.querySelectorAll('.lk-line').length > 7")


def test_a_phone_loads_on_tap_and_does_not_scroll_sideways(chromium, visit):
    """Before the tap there is neither canvas nor robot; after it the page fits the width."""
    page = visit(chromium, "motion", phone=True)
    page.wait_for_timeout(300)
    assert page.locator("canvas").count() == 0
    assert page.evaluate("!globalThis.labkitRobot")
    page.get_by_role("button", name="Tap to load").click()
    page.wait_for_selector("[data-ready]")
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")


def test_the_live_demos_answer_to_their_dials(chromium, visit):
    """Both demos show other numbers."""
    page = visit(chromium, "demos")
    page.evaluate("document.querySelectorAll('.lk-embed').forEach(e => e.scrollIntoView())")
    page.locator("[data-ready]").nth(1).wait_for()
    text = page.inner_text(".lk-demo[aria-label='Jacobian, live'] .lk-readout")
    page.get_by_role("slider", name="e1").focus()
    page.keyboard.press("ArrowRight")
    assert page.inner_text(".lk-demo[aria-label='Jacobian, live'] .lk-readout") != text
    words = page.locator(".lk-demo[aria-label='Orientation error, live'] .lk-readout")
    page.get_by_label("pitch, typed").first.fill("0.5")
    page.get_by_label("pitch, typed").first.press("Enter")
    assert "rad apart" in words.inner_text()


@pytest.mark.parametrize("name", ["motion", "several", "demos"])
@pytest.mark.parametrize("look", ["light", "dark", "phone"])
def test_axe_finds_nothing(chromium, visit, name, look):
    """No rule of accessibility is broken in light or dark or on a phone, all viewers loaded."""
    phone = look == "phone"
    page = visit(chromium, name, phone=phone, theme="light" if phone else look)
    page.evaluate("""async () => {
        for (const e of document.querySelectorAll('.lk-embed')) {
            e.querySelector('.lk-load')?.click();
            e.scrollIntoView();
            while (!e.querySelector('[data-ready]')) await new Promise((r) => setTimeout(r, 30));
        }
    }""")
    assert violations(page) == []


def test_the_notebook_front_end_asks_for_its_files_once(chromium):
    """The anywidget contract: two cells, one transfer."""
    page = chromium.new_page()
    page.set_content("<div id='a'></div><div id='b'></div>")
    page.set_default_timeout(120_000)  # a guard against hanging only
    files = [shared_files()[n].read_text() for n in ("viewer.js", "robot.js")]
    source = (ROOT / "labkit/data/viewer/widget.js").read_text()
    asked = page.evaluate(
        """async ([source, files, data]) => {
            let asked = 0;
            const bytes = files.map((f) => new DataView(new TextEncoder().encode(f).buffer));
            const model = () => {
                const heard = [], on = (k, f) => k === "msg:custom" && heard.push(f);
                return { get: () => data, on, off() {},
                    send: ({ kind }) => { asked++; heard.forEach((f) => f({ kind }, bytes)); } };
            };
            const at = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
            const front = (await import(at)).default;
            for (const id of ["a", "b"]) {
                await front.render({ model: model(), el: document.getElementById(id) });
            }
            return asked;
        }""",
        [source, files, swing(2.0, ghosts=0).to_json()],
    )
    assert asked == 1
    page.wait_for_selector("#a [data-ready]")
    page.wait_for_selector("#b [data-ready]")
    page.close()
