"""The live arm's page without a kernel: what keys and pointer say, and what is told to them."""

import json

import pytest
from accessibility import violations
from figures.embed import shared_files

import labkit as lk
from labkit.replay.player import VIEWER


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
    yield page
    page.close()


def opened(chromium, data, how=""):
    """A page whose kernel goes when `link.gone` is set: it is "cut", "deaf", or "none"."""
    page = chromium.new_page(viewport={"width": 800, "height": 1000})
    page.set_content("<!doctype html><html lang='en'><body><div id='a'></div></body></html>")
    page.set_default_timeout(120_000)  # a guard against hanging only
    for name in ("viewer.js", "robot.js"):
        page.add_script_tag(content=shared_files()[name].read_text())
    page.evaluate(
        """([data, how]) => {
            window.sent = [];
            window.link = how === "none" ? undefined : { hear: (f) => { window.tell = f; },
                cut: () => how === "cut" && link.gone,
                send: (m) => { if (link.gone) throw new Error("Cannot send"); sent.push(m); } };
            labkitViewer.mount(document.getElementById("a"), data, link);
        }""",
        [json.loads(data), how],
    )
    page.wait_for_selector("[data-ready]")
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


def frame(data, **changes):
    return {**json.loads(data)["first"], **changes}


def test_keys_push_as_the_pointer_does(page):
    """With keys alone, under "More": choose the elbow, 12 N, along y; pressed again it ends."""
    page.get_by_text("More").click()
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


@pytest.mark.parametrize("size", [(940, 600), (390, 844)])
def test_picture_curve_and_dials_are_on_one_screen(page, size):
    """In a notebook of 1366 x 768 below its head, and on a phone; eight controls at most."""
    page.set_viewport_size({"width": size[0], "height": size[1]})
    page.wait_for_timeout(100)
    assert page.locator(".lk-player").bounding_box()["height"] < size[1]
    assert page.locator(":is(button, input, select, summary):visible").count() <= 8


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


def test_buttons_and_dials_are_told_to_the_kernel(page):
    """Start, reset, the other law and a dial."""
    for name in ("Start", "Reset"):
        page.get_by_role("button", name=name, exact=True).click()
    page.get_by_label("Controller").select_option("stiff")
    page.get_by_label("factor").focus()
    page.keyboard.press("End")
    page.wait_for_function("sent.some((m) => m.kind === 'dial')")
    assert [m["kind"] for m in page.evaluate("sent")] == ["go", "reset", "law", "dial"]
    assert sent(page, "dial")[0] == {"kind": "dial", "name": "factor", "value": 2}


def test_keys_in_a_view_stay_there(chromium, data):
    """The notebook hears no key but Ctrl+S from picture, buttons, boxes, and what lies between."""
    page = opened(chromium, data, "none")
    page.evaluate(
        """async ([source, data]) => {
            document.getElementById("a").replaceChildren();
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
    for place in ("canvas", ".lk-play", "select", ".lk-readout"):
        page.locator(place).first.click(position={"x": 3, "y": 3})
        for key in ("d", "a", "0", "Escape", "Shift+M", "Control+m", "Control+s"):
            page.keyboard.press(key)
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
    page.evaluate("(f) => tell(f)", told | {"link": 3, "t": 1.05})
    assert "your force 10.0 N at the elbow (e1)" in page.inner_text(".lk-readout")
    words = "soft lost the arm at t = 1.000 s"
    page.evaluate("(f) => tell(f)", frame(data, state="stopped", note=words, t=1.1))
    assert page.inner_text(".lk-say") == words
    page.locator("[role=status]").filter(has_text=words).wait_for(state="attached")
    assert first["state"] == "ready"


GONE = "The kernel was restarted or shut down, and this arm ended with it: run the notebook"


@pytest.mark.parametrize("how", ["cut", "deaf"])
def test_a_kernel_that_is_gone_is_told_with_what_to_do(chromium, data, how):
    """A line that is cut is seen within seconds, or as soon as something is sent."""
    page = opened(chromium, data, how)
    assert page.is_hidden(".lk-say")
    page.evaluate("link.gone = true")
    if how == "deaf":
        page.get_by_role("button", name="Start").click()
    page.locator(".lk-say", has_text=GONE).wait_for()
    page.locator("[role=status]").filter(has_text=GONE).wait_for(state="attached")
    assert page.get_by_role("button", name="Start").is_disabled()
    assert page.get_by_label("factor").is_disabled()
    page.close()


def test_without_a_kernel_it_says_so(chromium, data):
    """In a page without a kernel the arm stands still, and says what to do."""
    page = opened(chromium, data, "none")
    assert "needs a running kernel" in page.inner_text(".lk-say")
    assert page.get_by_role("button", name="Start").is_disabled()
    page.close()


def test_a_live_page_breaks_no_rule_of_access(page):
    """No finding of axe's in the live arm's controls."""
    assert violations(page, "#a") == []
