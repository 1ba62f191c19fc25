"""The live arm in the book, used by mouse, finger and keys, light, dark and small."""

import json
import re

import pytest
from accessibility import COLOURS, violations
from test_pages import too_wide

pytestmark = pytest.mark.slow
PAGES = ("index", "live", "stiffness", "age", "singular")
PLACES = {
    "stiffness": "chapters/impedance",
    "age": "chapters/tags",
    "singular": "deeper/redundancy",
}
"""Where the panels of one idea are."""
ERROR = "document.querySelector('.lk-live').live.now.error"  # of the tip, in [m]
OFF, BACK = f"{ERROR} > 0.01", f"{ERROR} < 0.003"


@pytest.fixture
def live(visit, open_chromium):
    """Open a page, or that of an idea, and load its live arm, alone."""

    def go(name, **options):
        page = visit(f"{PLACES.get(name, name)}.html", browser=open_chromium, **options)
        piece = f'"piece": "{name if name in PLACES else "open"}"'
        page.evaluate("""piece => document.querySelectorAll('.lk-live').forEach((e) => {
            if (!e.querySelector('script').textContent.includes(piece)) e.remove();
        })""", piece)  # fmt: skip
        page.locator(".lk-live .lk-load").first.click()
        page.wait_for_selector(".lk-live [data-ready]")
        page.evaluate("document.querySelectorAll('.lk-more').forEach((e) => { e.open = true; })")
        return page

    return go


def type_into(page, label, value):
    """Type a number into a dial."""
    field = page.get_by_label(f"{label}, typed").first
    field.fill(str(value))
    field.press("Enter")


def choose(page, label, words):
    """Choose from a list by its label."""
    page.get_by_label(label, exact=True).select_option(words)


def tip_on_screen(page):
    """Where the tip is in the window, in [px]."""
    return page.evaluate("""() => {
        const { picture } = document.querySelector('.lk-live').live, { stage } = picture;
        stage.canvas.scrollIntoView({ block: 'center' });
        stage.rig.frame(stage.canvas.clientWidth / stage.canvas.clientHeight);
        const box = stage.canvas.getBoundingClientRect();
        const p = stage.camera.position.clone().fromArray(picture.tip.p).project(stage.camera);
        return [box.left + (p.x + 1) * box.width / 2, box.top + (1 - p.y) * box.height / 2];
    }""")


@pytest.mark.parametrize("name", PAGES)
def test_a_live_page_is_quiet_accessible_and_fits(live, name):
    """Loaded and running: on a phone, on a desk in light and dark; no request, no complaint."""
    page = live(name, phone=True, reduced_motion="reduce")
    assert not too_wide(page, 390)
    assert violations(page) == [], "phone"
    page.set_viewport_size({"width": 1280, "height": 900})
    assert violations(page) == [], "light"
    page.evaluate("document.documentElement.dataset.theme = 'dark'")
    assert violations(page, only=COLOURS) == [], "dark"


CUT = """() => {
    const pen = document.createElement("canvas").getContext("2d"), found = [];
    for (const part of document.querySelectorAll(".lk-live fieldset *")) {
        const field = part.parentElement.closest("fieldset").getBoundingClientRect();
        if (part.getBoundingClientRect().right > field.right - 2) found.push(part.textContent);
    }
    for (const list of document.querySelectorAll(".lk-live select")) {
        pen.font = getComputedStyle(list).font;
        const longest = Math.max(...[...list.options].map((o) => pen.measureText(o.text).width));
        if (longest + 26 > list.clientWidth && list.clientWidth) found.push(list.value);
    }
    return found;
}"""


@pytest.mark.parametrize("name", PAGES)
def test_no_unit_and_no_name_is_cut_on_a_phone(live, name):
    """What a field holds stays within its frame, and the longest name within its list."""
    page = live(name, phone=True, reduced_motion="reduce")
    page.evaluate("document.querySelectorAll('details').forEach((e) => { e.open = true; })")
    assert page.evaluate(CUT) == []


def test_a_mouse_pulls_the_hand_and_lets_it_go(live):
    """Dragged, the hand leaves its target and the force is shown; let go, it returns."""
    page = live("live")
    choose(page, "Arm", "ideal arm")
    choose(page, "Path", "stay")
    page.wait_for_function(BACK)
    x, y = tip_on_screen(page)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 60, y + 10, steps=4)
    page.wait_for_function(
        "/your pull \\d/.test(document.querySelector('.lk-readout').textContent)"
    )
    page.wait_for_function(OFF)
    page.wait_for_function(OFF.replace("now", "curves.last.at(-1)"))
    page.mouse.up()
    page.wait_for_function(BACK)


def test_the_cursor_says_what_can_be_taken_hold_of(live):
    """A hand over the arm and over a tag's corner, closed while this is dragged, else an arrow."""
    page = live("live")
    canvas = page.locator("canvas.lk-canvas")

    def cursor_is(name):
        page.wait_for_function("([c, name]) => getComputedStyle(c).cursor === name",
                               arg=[canvas.element_handle(), name])  # fmt: skip

    choose(page, "Arm", "ideal arm")
    choose(page, "Path", "stay")
    page.wait_for_function(BACK)
    x, y = tip_on_screen(page)
    page.mouse.move(x, y)
    cursor_is("grab")
    box = canvas.bounding_box()
    page.mouse.move(box["x"] + 8, box["y"] + 8)
    cursor_is("default")
    corners = live("age").locator(".lk-corners")
    grip = corners.locator(".lk-grip").first
    look = "e => getComputedStyle(e).cursor"
    assert grip.evaluate(look) == "grab"
    grip.hover()
    corners.page.mouse.down()
    assert corners.evaluate(look) == "grabbing"
    corners.page.mouse.up()
    assert corners.evaluate(look) != "grabbing"


def test_a_finger_pulls_the_hand(live):
    """The same by touch."""
    page = live("live", phone=True, has_touch=True)
    choose(page, "Arm", "ideal arm")
    choose(page, "Path", "stay")
    page.wait_for_function(BACK)
    x, y = tip_on_screen(page)
    touch = page.context.new_cdp_session(page)

    def finger(kind, *at):
        points = [{"x": at[0], "y": at[1]}] if at else []
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    finger("touchStart", x, y)
    finger("touchMove", x + 20, y)
    finger("touchMove", x + 50, y)
    page.wait_for_function(OFF)
    finger("touchEnd")
    page.wait_for_function(BACK)


def test_keys_push_the_tip_and_a_screen_reader_is_told(live):
    """The button pushes with 10 N for a second, and that is said; an arrow key moves each dial."""
    page = live("live")
    choose(page, "Arm", "ideal arm")
    choose(page, "Path", "stay")
    page.get_by_label("Push along +y").press("Enter")
    page.wait_for_function(f"{ERROR} > 0.025")
    told = page.locator(".lk-player > [role=status]").inner_text()
    assert "10 N along +y" in told or "mm from its target" in told
    for dial in page.locator(".lk-live input[type=range]").all():
        before = dial.input_value()
        dial.press("ArrowLeft" if before == dial.get_attribute("max") else "ArrowRight")
        assert dial.input_value() != before


def test_a_dial_makes_a_new_curve_and_the_old_one_stays(live):
    """The same axes, the run before it faint."""
    page = live("live")
    page.wait_for_function("document.querySelector('.lk-live').live.curves.last")
    choose(page, "Arm", "realistic arm")
    choose(page, "Controller", "joint velocity")
    said = page.locator(".lk-kept").last
    page.wait_for_function(
        "document.querySelector('.lk-live .lk-plot').querySelectorAll('polyline').length === 2"
    )
    before = said.inner_text()
    type_into(page, "Kp", 9)
    page.wait_for_function(
        "before => document.querySelector('.lk-live').live.said.textContent !== before", arg=before
    )
    assert "Kp 9" in said.inner_text()


def test_no_single_stiffness_keeps_both_limits_and_two_do(live):
    """K = 1000 N/m presses with 23.1 N as the page says; Kx = 300 with Kz = 1000 N/m keeps both."""
    page = live("stiffness")
    page.get_by_label("Your prediction in N").fill("30")
    page.get_by_role("button", name="Try it").click()
    verdict = page.locator(".lk-kept", has_text="At rest")

    def settled():
        page.wait_for_function("document.querySelector('.lk-live').live.told === true")
        return json.loads(
            page.evaluate(
                "JSON.stringify({...document.querySelector('.lk-live [data-ready]').dataset})"
            )
        )

    found = settled()
    assert float(found["wall"]) == pytest.approx(0.03 / (1 / 1000 + 1 / 3333.3), rel=0.02)
    assert float(found["sag"]) == pytest.approx(1000 * 0.3 * 9.81 / 1000, rel=0.05)
    assert "the answer is 23" in page.locator(".lk-predict").inner_text()
    choose(page, "Hold by", "Kx, Ky, Kz")
    for name, value in {"Kx": 300, "Kz": 1000}.items():
        type_into(page, name, value)
    settled()
    assert "Both limits are kept" in verdict.inner_text()


def test_the_wall_tells_nothing_before_the_reader_has(live):
    """Bars, numbers and the arrow of "Stiffness has a direction" wait for a prediction."""
    page = live("stiffness", phone=True)
    bars, readout = page.locator(".lk-bars"), page.locator(".lk-live .lk-readout")
    page.wait_for_function("document.querySelector('.lk-live').live.now.t > 2.5")
    assert bars.is_hidden()
    assert re.fullmatch(r"t = [\d.]+ s", readout.inner_text())
    forces = page.locator(".lk-tag:visible", has_text="N")
    assert forces.count() == 0
    page.keyboard.type("20")  # the box has the focus
    page.keyboard.press("Enter")
    bars.wait_for()
    forces.wait_for()
    assert "wall" in readout.inner_text()


def test_the_tag_tells_nothing_before_the_reader_has(live):
    """Numbers, curves and table of "Age, not noise" wait for a prediction, typed by keys."""
    page = live("age", phone=True)
    results = page.locator(".lk-live .lk-table")
    assert results.is_hidden()
    assert "from the tag" not in page.inner_text(".lk-live .lk-readout")
    page.keyboard.type("12")  # the box has the focus
    page.keyboard.press("Enter")
    results.wait_for()
    assert "the answer is 13" in page.inner_text(".lk-predict")


def test_half_a_pixel_flips_a_tag(live):
    """By keys: at 1.5 m and 10 degrees one corner's half pixel changes the better pose."""
    page = live("age")
    type_into(page, "Distance", 1.5)
    type_into(page, "Turned by", 10)
    page.get_by_label("Corner", exact=True).select_option("upper right")
    page.get_by_label("Corner down ½ px").press("Enter")
    assert "flipped: now B" in page.locator(".lk-twoposes [role=status]").inner_text()
