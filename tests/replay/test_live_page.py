"""The live arm's page without a kernel: what keys and pointer say, and what is told to them."""

import json

import numpy as np
import pytest
from accessibility import violations
from figures.embed import shared_files

import labkit as lk
from labkit.replay.player import VIEWER
from labkit.replay.surroundings import POINTS


@pytest.fixture(scope="module")
def data():
    """What the page is given for an arm with a wall, two laws and a dial."""
    robot = lk.robot("left")
    T = lk.Model(robot).pose(robot.ready)
    wall = lk.Wall(T[:3, 3] + [0.1, 0.0, 0.0], (-1.0, 0.0, 0.0), size=(0.3, 0.3))

    def soft(state, target, factor):
        return lk.JointVelocity(robot.zeros)

    with lk.Arm(robot, q0=robot.ready, world=lk.World(things=[wall])) as arm:
        laws = {"soft": soft, "stiff": lk.control.hold(robot.ready)}
        circle = lk.Circle(T[:3, 3], T[:3, 3] + [0.0, 0.05, 0.0])
        target = lk.Trajectory(lk.PosePath(circle, T[:3, :3]), lk.Quintic(5.0))
        view = lk.live(arm, target, laws, title="Feel it", factor=(0.0, 2.0, 1.0))
        return view.data


@pytest.fixture
def page(chromium, data):
    """The arm in a page; `sent` is what it said to the kernel, `tell` is what the kernel says."""
    page = opened(chromium, data)
    page.wait_for_selector("[data-ready]")
    yield page
    page.close()


def opened(chromium, data, how=""):
    """A page whose kernel goes when `link.gone` is set: its line is "cut", or it is "deaf"."""
    page = chromium.new_page(viewport={"width": 800, "height": 1000})
    page.set_content("<!doctype html><html lang='en'><body><div id='a'></div></body></html>")
    page.set_default_timeout(120_000)  # a guard against hanging only
    for name in ("viewer.js", "robot.js"):
        page.add_script_tag(content=shared_files()[name].read_text())
    page.evaluate(
        """([data, how]) => {
            window.sent = [];
            window.link = { hear: (f) => { window.tell = f; },
                cut: () => how === "cut" && link.gone,
                send: (m) => { if (link.gone) throw new Error("Cannot send"); sent.push(m); } };
            labkitViewer.mount(document.getElementById("a"), data, link);
        }""",
        [json.loads(data), how],
    )
    return page


def sent(page, kind):
    return [message for message in page.evaluate("sent") if message["kind"] == kind]


SPOT = """(at) => {
    const { picture } = document.querySelector("[data-ready]").labkit;
    const box = picture.stage.canvas.getBoundingClientRect();
    const p = picture.stage.camera.position.clone().set(...at ?? picture.frames.left_w1.p);
    p.project(picture.stage.camera);
    return [box.x + (p.x + 1) * box.width / 2, box.y + (1 - p.y) * box.height / 2];
}"""
LIVE = "document.querySelector('[data-ready]').labkit"
CURSOR = "getComputedStyle(document.querySelector('canvas.lk-canvas')).cursor"


def frame(data, **changes):
    return {**json.loads(data)["first"], **changes}


def test_keys_push_as_the_pointer_does(page):
    """With keys alone: choose the elbow, 12 N, along y; pressed again it ends."""
    page.get_by_label("Push at").select_option("elbow (e1)")
    page.get_by_label("Force in newtons").fill("12")
    button = page.get_by_role("button", name="Push along plus y")
    button.focus()
    page.keyboard.press("Enter")
    page.wait_for_function("sent.filter((m) => m.kind === 'hand').length > 2")  # it holds on
    assert sent(page, "hand")[0] == {
        "kind": "hand", "link": 3, "local": [0, 0, 0], "force": [0, 12, 0],
    }  # fmt: skip
    assert button.get_attribute("aria-pressed") == "true"
    page.keyboard.press("Enter")
    assert "force" not in sent(page, "hand")[-1]
    assert button.get_attribute("aria-pressed") == "false"


def test_another_force_applies_while_it_pushes(page):
    """A number typed into the force box changes the push that is on; one above 60 N becomes 60."""
    page.get_by_role("button", name="Push along plus y").click()
    box = page.get_by_label("Force in newtons")
    for typed, force in (("25", 25), ("99", 60)):
        box.fill(typed)
        box.press("Enter")
        assert sent(page, "hand")[-1]["force"] == [0, force, 0]
    assert box.input_value() == "60"
    assert page.inner_text(".lk-say") == "A push is at most 60 N."


def test_a_force_above_the_limit_is_corrected_before_any_push(page):
    """Left with 100 N in it, the box says 60 and the page says why; nothing is pushed."""
    box = page.get_by_label("Force in newtons")
    box.fill("100")
    box.blur()
    assert box.input_value() == "60"
    assert page.inner_text(".lk-say") == "A push is at most 60 N."
    assert not sent(page, "hand")


@pytest.mark.parametrize(("link", "told"), [(6, "at joint w2"), (7, "at the tip")])
def test_a_link_is_named_in_a_sentence(page, data, link, told):
    """A joint is a joint by its name, the tip is the tip."""
    at = json.loads(data)["first"]["things"]["target"]["position"]
    page.evaluate("(f) => tell(f)", frame(data, force=[0, 10, 0], at=at, link=link))
    assert f"your force 10.0 N {told}" in page.inner_text(".lk-readout")


@pytest.mark.parametrize("size", [(940, 690), (390, 844)])
def test_picture_curve_and_dials_are_on_one_screen(page, size):
    """In a notebook of 1280 x 800, and on a phone."""
    page.set_viewport_size({"width": size[0], "height": size[1]})
    page.wait_for_timeout(100)
    parts = (".lk-stage", ".lk-play", ".lk-plot", ".lk-readout", ".lk-livedials")
    boxes = [page.locator(part).first.bounding_box() for part in parts]
    ends = [box["y"] + box["height"] for box in boxes]
    assert max(ends) - boxes[0]["y"] < size[1]


def test_the_view_begins_with_its_title(page):
    """As a replay does; so two views of a notebook are told apart."""
    title = page.locator(".lk-live > .lk-title")
    assert title.is_visible() and title.inner_text() == "Feel it"


def test_no_box_of_a_dial_is_cut_at_the_edge_of_a_notebook_on_a_phone(page):
    """JupyterLab leaves 275 of 390 pixels: box and unit stay within them."""
    page.set_viewport_size({"width": 275 + 16, "height": 844})
    page.wait_for_timeout(100)
    edge = page.evaluate("document.querySelector('.lk-live').getBoundingClientRect().right")
    for box in page.locator(".lk-dial > *").all():
        place = box.bounding_box()
        assert place["x"] + place["width"] <= edge - 1, box.inner_html()


@pytest.mark.parametrize("width", [740, 800, 880, 940])
def test_no_unit_is_cut_in_the_column_beside_the_picture(chromium, width):
    """A notebook of 1280 pixels leaves about 880; no part of a dial is wider than its column."""
    robot = lk.robot("left")

    def soft(state, target, stiffness):
        return lk.JointVelocity(robot.zeros)

    with lk.Arm(robot, q0=robot.ready) as arm:
        dial = {"stiffness": (50.0, 1500.0, 300.0, "N/m")}
        view = lk.live(arm, lk.Hold(robot.ready, 5.0), {"soft": soft}, **dial)
        page = opened(chromium, view.data)
    page.wait_for_selector("[data-ready]")
    page.set_viewport_size({"width": width, "height": 800})
    page.wait_for_timeout(100)
    edge = page.locator(".lk-dial").evaluate("(dial) => dial.getBoundingClientRect().right")
    for part in page.locator(".lk-dial > *").all():
        place = part.bounding_box()
        assert place["x"] + place["width"] <= edge + 1
    page.close()


def test_the_path_of_the_target_is_drawn_and_goes_where_it_is_dragged(page, data):
    """Each point that the kernel told, moved with the target."""
    path = json.loads(data)["path"]
    assert len(path) == POINTS
    assert np.allclose(np.ptp(path, axis=0), [0.1, 0.1, 0.0], atol=1e-3)
    things = json.loads(data)["first"]["things"]
    things["target"]["shift"] = [0.1, 0.2, 0.3]
    page.evaluate("(f) => tell(f)", frame(data, things=things))
    drawn = page.evaluate(f"{LIVE}.path.position.toArray()")
    assert drawn == [0.1, 0.2, 0.3]
    assert page.evaluate(f"{LIVE}.path.parent === {LIVE}.picture.stage.scene")


@pytest.mark.parametrize(("name", "kind"), [("Reset", "reset"), ("Stop", "close")])
def test_reset_and_stop_end_a_push(page, name, kind):
    """The push is released before the kernel hears of Reset or Stop, and never taken up again."""
    push = page.get_by_role("button", name="Push along minus z")
    push.click()
    page.get_by_role("button", name=name, exact=True).click()
    assert push.get_attribute("aria-pressed") == "false"
    page.wait_for_timeout(200)  # three beats
    *_, released, last = page.evaluate("sent")
    assert released == {"kind": "hand", "link": 0, "local": [0, 0, 0]}
    assert last == {"kind": kind}


def test_a_pull_at_an_arm_that_was_reset_is_over(page):
    """A pointer that is still down when the arm goes back pulls at nothing."""
    x, y = page.evaluate(SPOT)
    page.mouse.move(x, y)
    page.mouse.down()
    page.get_by_role("button", name="Reset", exact=True).press("Enter")
    before = len(sent(page, "hand"))
    page.mouse.move(x + 60, y)
    page.mouse.up()
    assert len(sent(page, "hand")) == before


def test_the_arrow_of_a_push_stands_outside_the_arm(page, data):
    """A push at the elbow's middle is drawn from the arm's surface on, along the push."""
    page.get_by_label("Push at").select_option("elbow (e1)")
    page.get_by_role("button", name="Push along plus y").click()
    middle = page.evaluate(f"{LIVE}.picture.frames.left_e1.p")
    told = frame(data, state="running", at=middle, force=[0, 10, 0], link=3, t=1.0)
    page.evaluate("(f) => tell(f)", told)
    away = page.evaluate(f"{LIVE}.picture.arrows.force.mark.position.toArray()")
    assert away[0] == pytest.approx(middle[0], abs=1e-6)
    assert 0.04 < away[1] - middle[1] < 0.12
    assert away[2] == pytest.approx(middle[2], abs=1e-6)


def test_a_slow_page_asks_for_patience(page):
    """A page whose timers had no turn for a while says so with the pointer's next word."""
    x, y = page.evaluate(SPOT)
    page.mouse.move(x, y)
    page.mouse.down()
    page.evaluate("() => { const end = Date.now() + 300; while (Date.now() < end); }")
    page.wait_for_function("sent.at(-1).every >= 0.25")
    page.mouse.up()
    assert "every" not in sent(page, "hand")[-1]


def test_a_pointer_on_the_arm_pulls_and_beside_it_turns_the_view(page):
    """Down on the hand it takes hold of it and pulls where it goes; on nothing it turns."""
    x, y = page.evaluate(SPOT)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 60, y)
    pulls = sent(page, "hand")
    assert pulls[0]["link"] in (4, 5, 6, 7)
    assert pulls[-1]["to"] != pulls[0]["to"]
    page.mouse.up()
    assert "to" not in sent(page, "hand")[-1]
    rig = "document.querySelector('[data-ready]').labkit.picture.stage.rig"
    before, count = page.evaluate(f"{rig}.azimuth"), len(sent(page, "hand"))
    box = page.locator("canvas").first.bounding_box()
    page.mouse.move(box["x"] + 10, box["y"] + 10)
    page.mouse.down()
    page.mouse.move(box["x"] + 90, box["y"] + 10)
    page.mouse.up()
    assert page.evaluate(f"{rig}.azimuth") != before
    assert len(sent(page, "hand")) == count


def test_the_answer_to_a_move_is_drawn_before_all_else(page, data):
    """A picture waits for the answer to the pointer, and is drawn as soon as that comes."""
    drawn, quiet = page.evaluate(
        """(frame) => {
            const live = document.querySelector("[data-ready]").labkit, { stage } = live.picture;
            const drawn = [];
            for (const move of [0, 1]) {
                const before = live.frames;
                stage.hold();
                tell({ ...frame, move });
                drawn.push(live.frames - before);
            }
            return [drawn, stage.quiet];
        }""",
        frame(data),
    )
    assert drawn == [0, 1]
    assert quiet == 0


def test_the_cursor_says_what_can_be_taken_hold_of(page, data):
    """A hand over link and wall, a closed one to drag, an arrow over what stays where it is."""

    def cursor_is(name):
        page.wait_for_function(f"{CURSOR} === '{name}'")

    wall = json.loads(data)["first"]["things"]["thing 0"]["position"]
    box = page.locator("canvas").first.bounding_box()
    nothing = box["x"] + 10, box["y"] + 10
    page.mouse.move(*nothing)
    cursor_is("default")
    page.mouse.move(*page.evaluate(SPOT))
    cursor_is("grab")
    page.mouse.down()
    cursor_is("grabbing")
    page.mouse.move(*nothing)
    cursor_is("grabbing")
    page.mouse.up()
    page.mouse.move(nothing[0], nothing[1] + 5)
    cursor_is("default")
    corner = [wall[0], wall[1] - 0.1, wall[2] - 0.1]
    page.mouse.move(*page.evaluate(SPOT, corner))
    cursor_is("grab")
    things = json.loads(data)["first"]["things"]
    things["thing 0"]["fixed"] = True
    page.evaluate("(f) => tell(f)", frame(data, things=things))
    page.mouse.move(*page.evaluate(SPOT, [*corner[:2], corner[2] - 0.01]))
    cursor_is("default")


def test_buttons_and_dials_are_told_to_the_kernel(page):
    """Start, step, reset, keep, the other law and a dial."""
    for name in ("Start", "Step", "Reset", "Keep this run", "Stop"):
        page.get_by_role("button", name=name, exact=True).click()
    page.get_by_label("Controller").select_option("stiff")
    page.get_by_label("factor, typed").fill("1.5")
    page.get_by_label("factor, typed").press("Enter")
    page.wait_for_function("sent.some((m) => m.kind === 'dial')")
    kinds = [m["kind"] for m in page.evaluate("sent")]
    assert kinds == ["go", "step", "reset", "keep", "close", "law", "dial"]
    assert sent(page, "dial")[0] == {"kind": "dial", "name": "factor", "value": 1.5}


def test_enter_applies_a_number_that_was_typed_back(page):
    """Each Enter in a dial's box tells the kernel its number, also the one that it had before."""
    box = page.get_by_label("factor, typed")
    for k, typed in enumerate(("1.5", "1", "1"), start=1):
        box.click()
        box.press("Control+a")
        page.keyboard.type(typed)
        page.keyboard.press("Enter")
        page.wait_for_function(f"sent.filter((m) => m.kind === 'dial').length === {k}")
        assert sent(page, "dial")[-1]["value"] == float(typed)


def test_keys_in_a_view_stay_there(chromium, data):
    """The notebook hears no key but Ctrl+S from picture, buttons, boxes, and what lies between."""
    page = chromium.new_page()
    page.set_content("<!doctype html><html lang='en'><body><div id='a'></div></body></html>")
    page.set_default_timeout(120_000)
    for name in ("viewer.js", "robot.js"):
        page.add_script_tag(content=shared_files()[name].read_text())
    page.evaluate(
        """async ([source, data]) => {
            window.heard = [];
            document.addEventListener("keydown", (e) => heard.push(e.key));
            window.labkitLoad = async () => labkitViewer;
            const file = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
            const model = { get: () => data, on() {}, off() {}, send() {} };
            (await import(file)).default.render({ model, el: document.getElementById("a") });
        }""",
        [(VIEWER / "widget.js").read_text(), data],
    )
    page.wait_for_selector("[data-ready]")
    places = (
        page.locator("canvas").first,
        page.get_by_role("button", name="Start"),
        page.get_by_label("factor, typed"),
        page.get_by_label("Controller"),
        page.locator(".lk-readout"),
    )
    for place in places:
        place.click(position={"x": 3, "y": 3})
        for key in ("d", "d", "a", "b", "x", "z", "m", "y", "0", "Escape", "Shift+M", "Control+m"):
            page.keyboard.press(key)
        page.keyboard.press("Control+s")
        assert page.evaluate("heard.splice(0)") == ["s"]
    page.close()


def test_force_and_sentence_are_shown_and_said(page, data):
    """The force in newtons is at its arrow; a stopped law's sentence is beside the picture."""
    first = frame(data)
    tip = json.loads(data)["first"]["things"]["target"]["position"]
    told = frame(data, state="running", force=[0, 10, 0], at=tip, link=7, error=0.0333, t=1.0)
    page.evaluate("(f) => tell(f)", told | {"spent": [5]})
    page.locator(".lk-tag", has_text="10.0 N").wait_for()
    pulled = "33.3 mm from the target · your force 10.0 N at the tip · at its torque limit: w1"
    assert pulled in page.inner_text(".lk-readout")
    page.evaluate("(f) => tell(f)", told | {"link": 3, "kept": [12.5], "t": 1.05})
    assert "your force 10.0 N at the elbow (e1) · 1 kept" in page.inner_text(".lk-readout")
    assert page.inner_text(".lk-say") == "Kept as view.log: the run of 12.5 s under soft."
    words = "soft lost the arm at t = 1.000 s"
    page.evaluate("(f) => tell(f)", frame(data, state="stopped", note=words, t=1.1))
    assert page.inner_text(".lk-say") == words
    page.locator("[role=status]").filter(has_text=words).wait_for(state="attached")
    assert first["state"] == "ready"


GONE = "The kernel was restarted or shut down, and this arm ended with it: run the notebook"


def test_the_box_tells_the_truth_where_the_page_takes_the_arm_in_late(page, data):
    """Made outside of the page, as by a cell that is run again: ticked, and the arm is alone."""
    hidden = page.evaluate(
        """(data) => {
            const host = document.createElement("div"), link = { send() {}, hear() {} };
            const { picture, sight } = labkitViewer.mount(host, data, link);
            const box = [...sight.element.querySelectorAll("label")]
                .find((label) => label.textContent === "Arm alone").firstChild;
            const shown = () => [box.checked, picture.body.groups.base.visible];
            const first = shown();
            picture.pose("right", data.first.q);
            return [first, shown(), picture.body.groups.right_w0.visible];
        }""",
        json.loads(data),
    )
    assert hidden == [[True, False], [True, False], True]


@pytest.mark.parametrize("how", ["cut", "deaf"])
def test_a_kernel_that_is_gone_is_told_with_what_to_do(chromium, data, how):
    """A line that is cut is seen within seconds, or as soon as something is sent."""
    page = opened(chromium, data, how)
    page.wait_for_selector("[data-ready]")
    assert page.is_hidden(".lk-say")
    page.evaluate("link.gone = true")
    if how == "deaf":
        page.get_by_role("button", name="Start").click()
    page.locator(".lk-say", has_text=GONE).wait_for()
    page.locator("[role=status]").filter(has_text=GONE).wait_for(state="attached")
    assert page.get_by_role("button", name="Start").is_disabled()
    assert page.get_by_label("factor, typed").is_disabled()
    assert page.get_by_role("button", name="Front").is_enabled()
    page.close()


def test_a_silent_kernel_is_told_only_while_its_arm_should_run(page, data):
    """The page says that a running arm was silent for 5 s, until the next word comes."""

    def after(seconds, **frame_):
        page.evaluate("(f) => tell(f)", frame(data, **frame_))
        page.evaluate(f"{LIVE}.came -= 1000 * {seconds}; {LIVE}.look()")
        return page.inner_text(".lk-say") if page.is_visible(".lk-say") else ""

    assert after(4.0, state="running") == ""
    assert after(9.0, state="paused") == ""
    assert after(9.0, state="running").startswith("Nothing has come from the kernel for 5 s. If it")
    assert after(0.0, state="running") == ""


def test_the_notebook_cuts_the_line_to_a_kernel_that_is_gone(chromium, data):
    """Shut down, JupyterLab has none; while one is restarted it says so, and only for a moment."""
    page = chromium.new_page()
    page.set_content("<!doctype html><html lang='en'><body></body></html>")
    cut = page.evaluate(
        """async ([source, data]) => {
            let link, live;
            globalThis.labkitLoad = async () => ({ mount: (...given) => { link = given[3]; } });
            const file = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
            const front = (await import(file)).default, found = [];
            const manager = { kernel: { status: "busy" } };
            const on = (name, f) => { if (name === "comm_live_update") live = f; };
            const model = { get: () => data, on, off() {}, send() {}, widget_manager: manager };
            const look = () => found.push(link.cut());
            const show = () => front.render({ model, el: document.createElement("div") });
            await show();
            look();
            manager.kernel = null;
            look();
            manager.kernel = { status: "restarting" };
            live();
            manager.kernel = { status: "idle" };
            look();
            await show(); // another cell
            delete model.widget_manager; // not every notebook has one
            look();
            return found;
        }""",
        [(VIEWER / "widget.js").read_text(), data],
    )
    assert cut == [False, True, True, False]
    page.close()


def test_a_force_that_is_held_is_said_once(page, data):
    """After a second, and again only when another force is held; never while it changes."""
    at = json.loads(data)["first"]["things"]["target"]["position"]
    page.evaluate(
        """() => {
            window.heard = [];
            const status = document.querySelector("[role=status]");
            new MutationObserver(() => heard.push(status.textContent))
                .observe(status, { childList: true });
        }"""
    )
    told = frame(data, state="running", at=at, link=7, error=0.0333)
    for size in (*range(5, 50, 5), *[40.0, 41.0] * 12, *[20.0] * 24):
        page.evaluate("(f) => tell(f)", told | {"force": [0, size, 0]})
        page.wait_for_timeout(60)
    heard = [words for words in page.evaluate("heard") if "N" in words]
    where = "; the tip is 33 mm from its target."
    assert heard == [f"Pulling the tip with {size} N{where}" for size in (heard[0][21:25], "20.0")]
    assert heard[0][21:25] in ("40.0", "41.0")


def test_without_a_kernel_it_says_so(chromium, data):
    """In a page without a kernel the arm stands still, and says what to do."""
    page = chromium.new_page()
    page.set_default_timeout(120_000)
    page.set_content("<!doctype html><html lang='en'><body><div id='a'></div></body></html>")
    for name in ("viewer.js", "robot.js"):
        page.add_script_tag(content=shared_files()[name].read_text())
    page.evaluate(
        "(data) => { labkitViewer.mount(document.getElementById('a'), data); }", json.loads(data)
    )
    assert "needs a running kernel" in page.inner_text(".lk-say")
    assert page.get_by_role("button", name="Start").is_disabled()
    page.close()


def test_a_live_page_breaks_no_rule_of_access(page):
    """No finding of axe's in the live arm's controls."""
    assert violations(page, "#a") == []
