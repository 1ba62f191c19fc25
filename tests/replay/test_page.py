"""The HTML of the static book and the notebook's widget, without a browser."""

import base64
import json
from dataclasses import replace
from html.parser import HTMLParser
from io import BytesIO

import numpy as np
import pytest
from figures.embed import (
    motion_html,
    shared_files,
)
from PIL import Image
from samples import swing

import labkit as lk
from labkit.errors import TypeMismatch
from labkit.replay import show
from labkit.replay.player import still


class Reader(HTMLParser):
    """Collects elements and the text of JSON scripts."""

    def __init__(self, html):
        super().__init__()
        self.elements, self.data = [], ""
        self.feed(html)

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, dict(attrs)))

    def handle_data(self, data):
        if self.elements and self.elements[-1] == ("script", {"type": "application/json"}):
            self.data += data


def test_a_figure_has_words_data_and_no_inline_code():
    """Title and alt are the motion's, the one script is a file, and no element has a style."""
    motion = swing(2.0)
    page = Reader(motion_html(motion, root="../_static/viewer/", poster="a.png"))
    assert json.loads(page.data)["title"] == motion.title
    assert ("img", {"class": "lk-poster", "src": "a.png", "alt": motion.alt}) in page.elements
    scripts = [a for tag, a in page.elements if tag == "script" and "type" not in a]
    assert scripts == [{"defer": None, "src": "../_static/viewer/boot.js"}]
    assert not [k for _, a in page.elements for k in a if k.startswith("on") or k == "style"]


def test_titles_cannot_break_out():
    """A title that ends the script and begins another stays data."""
    motion = replace(swing(1.0), title="</script><script>alert(1)</script>")
    page = Reader(motion_html(motion))
    assert sum(tag == "script" for tag, _ in page.elements) == 1
    assert json.loads(page.data)["title"] == motion.title


def test_the_widget_sends_the_files_when_asked_and_keeps_them_out_of_its_state():
    """Viewer and robot go whole on request, and the state is below 60 kB."""
    motion = swing(2.0)
    widget = show(motion)
    sent = []
    widget.send = lambda content, buffers=None: sent.append((content, buffers))
    widget._handle_custom_msg({"kind": "files"}, [])
    ((content, buffers),) = sent
    assert content == {"kind": "files"}
    assert [len(b) for b in buffers] == [
        shared_files()[n].stat().st_size for n in ("viewer.js", "robot.js")
    ]
    assert len(json.dumps(widget.get_state(), default=str)) < 60_000
    with pytest.raises(TypeMismatch):
        show(motion.q)


def test_a_saved_notebook_keeps_picture_and_words():
    """Before the widget stands an output with a picture and a caption, which needs no kernel."""
    motion = swing(1.0)
    kept = show(motion).fallback()
    page = Reader(kept["text/html"])
    (image,) = [attributes for tag, attributes in page.elements if tag == "img"]
    assert motion.title in image["alt"]
    assert motion.alt in kept["text/plain"]
    picture = Image.open(BytesIO(base64.b64decode(image["src"].split(",")[1])))
    pixels = np.array(picture).astype(int)
    assert picture.size == (640, 400)
    assert 0.02 < np.mean(pixels[:, :, 3] > 0) < 0.98, "the arm covers a part of it"
    near = np.abs(pixels - [179, 0, 27, 255]).max(axis=2) < 30
    assert near.any(), "the tip's path is drawn"


def test_a_still_shows_what_the_viewer_shows():
    """See-through arms are beside the arm."""
    plain = replace(swing(1.0, ghosts=0), path=None)

    def drawn(motion):
        return np.array(Image.open(BytesIO(still(motion)))).astype(int)

    first, seen = drawn(plain), drawn(replace(plain, ghosts={"other": plain.q + 0.3}))
    blue = (seen >= [0, 60, 100, 60]).all(axis=2) & (seen <= [130, 190, 255, 110]).all(axis=2)
    assert (blue & (seen != first).any(axis=2)).sum() > 50


def test_a_still_of_another_arm_is_a_line_from_joint_to_joint():
    """It has no meshes."""
    one = replace(lk.robot("left"), name="one")
    pixels = np.array(Image.open(BytesIO(still(replace(swing(1.0, ghosts=0), robot=one)))))
    assert (np.abs(pixels - [87.0, 96.0, 106.0, 255.0]).max(axis=2) < 30).sum() > 50
