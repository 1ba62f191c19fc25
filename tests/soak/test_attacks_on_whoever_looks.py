"""An instructor who looks at what was handed in is not harmed by it."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import mkdtemp

import pytest
from bleach._vendor import html5lib
from soak.attacks.attack import CANARY, markdown_cell
from soak.attacks.place import NAME, ROOT, place
from soak.attacks.shown import MARKUP

from labkit.__main__ import main
from labkit.course.authoring.layout import Course

pytestmark = pytest.mark.usefixtures("kept_worker")
soak = pytest.mark.soak
WRITES = "open({loot!r}, 'w').write('it ran')\n"


def formgrader(course, path, **settings):
    """The page that nbgrader's formgrader makes of a notebook, under the course's settings."""
    from nbconvert.exporters import HTMLExporter
    from nbgrader.server_extensions.formgrader import handlers
    from traitlets.config import Config
    from traitlets.config.loader import PyFileConfigLoader

    config = PyFileConfigLoader("nbgrader_config.py", path=str(course.root)).load_config()
    config.HTMLExporter.template_name = "formgrade"
    config.HTMLExporter.extra_template_basedirs = [handlers.template_path]
    config.merge(Config(settings))
    about = ("assignment_id", "notebook_id", "submission_id", "student", "last_name", "first_name")
    resources = dict.fromkeys((*about, "base_url", "notebook_path"), "x") | {"index": 0, "total": 1}
    return HTMLExporter(config=config).from_filename(str(path), resources=resources)[0]


def live(page):
    """What of a page is more than text to a browser, and was written by a student."""
    found = []
    for element in html5lib.parse(page, namespaceHTMLElements=False).iter():
        if not isinstance(element.tag, str):  # a comment
            continue
        tag, text = element.tag.rpartition("}")[2], "".join(element.itertext())
        if tag in ("script", "style") and ("GOT" in text or "http://x" in text):
            found.append(tag)
        for name, value in element.attrib.items():
            if ("GOT" in value or "http://x" in value) and (
                name.startswith("on")
                or name in ("href", "src", "srcdoc", "data", "action", "formaction", "content")
            ):
                found.append(f"{tag} {name}")
    return found


@pytest.fixture(scope="module", params=["script", pytest.param("all", marks=soak)])
def shown(request, released, tmp_path_factory):
    """Pages of formgrader's, of what was handed in and of what the grader has made of it."""
    course = Course(tmp_path_factory.mktemp("shown") / "course")
    shutil.copytree(released.root, course.root, symlinks=True)
    names = list(MARKUP) if request.param == "all" else ["script", "picture"]
    released_one = json.loads((course.release / NAME / f"{NAME}.ipynb").read_text())
    paths = {}
    for number, name in enumerate(names):
        folder = course.submitted / f"s{number:02d}" / NAME
        folder.mkdir(parents=True)
        cells = [*released_one["cells"], markdown_cell(MARKUP[name])]
        (folder / f"{NAME}.ipynb").write_text(json.dumps(released_one | {"cells": cells}))
        made = course.root / "autograded" / f"s{number:02d}" / NAME / f"{NAME}.ipynb"
        paths[name] = folder / f"{NAME}.ipynb", made
    assert main(["grade", NAME, "--course", str(course.root)]) == 0
    off = {"HTMLExporter": {"sanitize_html": False, "filters": {}}}
    return {
        name: (formgrader(course, raw, **off), formgrader(course, made))
        for name, (raw, made) in paths.items()
    }


def test_markup_is_live_undefended(shown):
    """The control: each is more than text on a page of the file as it was handed in."""
    assert not [name for name, (raw, _) in shown.items() if not live(raw)]


def test_no_markup_is_live(shown):
    """On the page that formgrader makes after grading, each is text."""
    assert not {name: found for name, (_, page) in shown.items() if (found := live(page))}


FILES = {
    "json.py": WRITES,
    "numpy.py": WRITES,
    "labkit/__init__.py": WRITES,
    "sitecustomize.py": WRITES,
    "dataclasses.py": WRITES,
    "nbgrader_config.py": WRITES,
}
CASES = [pytest.param(n, marks=() if n == "nbgrader_config.py" else soak) for n in FILES]


@pytest.mark.parametrize("name", CASES)
def test_no_file_beside_a_notebook_is_run(course, tmp_path, name):
    """Looking and grading from within a submission's folder run nothing of it."""
    folder = course.submitted / "mallory" / NAME
    folder.mkdir(parents=True)
    shutil.copy(course.release / NAME / f"{NAME}.ipynb", folder)
    loot = tmp_path / "loot"
    (folder / name).parent.mkdir(exist_ok=True)
    (folder / name).write_text(FILES[name].format(loot=str(loot)))
    env = dict(os.environ, PYTHONPATH=str(ROOT))
    labkit = [sys.executable, "-P", "-m", "labkit"]  # as its program does: no working folder
    for words in (["grade", NAME, "--student", "mallory"], ["export", NAME], ["feedback", NAME]):
        done = subprocess.run([*labkit, *words], cwd=folder, env=env, capture_output=True)
        assert not loot.exists(), words
        assert b"Traceback" not in done.stderr
    undefended(folder, name, env)
    assert loot.exists(), "the control"


def undefended(folder, name, env):
    """What runs a file that lies in the working folder."""
    words = (
        ["-m", "nbgrader", "list"]
        if name.startswith("nbgrader")
        else ["-c", f"import {name.partition('.')[0].partition('/')[0]}"]
    )
    if name == "sitecustomize.py":
        words = ["-S", *words]  # Debian's Python has loaded one of its own
    subprocess.run(
        [sys.executable, *words], cwd=folder, env=env | {"PYTHONPATH": ""}, capture_output=True
    )


SHOWN = {
    "beside Python": Path(sys.prefix) / "share",
    "in /usr/local/share": Path("/usr/local/share"),
}


@pytest.mark.parametrize(
    "where", [pytest.param(n, marks=() if n == "beside Python" else soak) for n in SHOWN]
)
def test_a_course_in_a_shown_place_is_safe_or_refused(released, where, capsys):
    """Where the sandbox shows the place of the course, one sentence says so, or it is kept."""
    folder = SHOWN[where] if os.access(SHOWN[where], os.W_OK) else SHOWN["beside Python"]
    root = Path(mkdtemp(prefix="labkit-test-", dir=folder))
    try:
        shutil.copytree(released.root, root / "course", symlinks=True)
        course = Course(root / "course")
        path = course.bundle / f"{NAME}.json"
        path.write_text(json.dumps(json.loads(path.read_text()) | {"canary": CANARY}))
        mallory = course.submitted / "mallory" / NAME
        mallory.mkdir(parents=True)
        notebook = json.loads((course.release / NAME / f"{NAME}.ipynb").read_text())
        reads = f"raise Exception(open({str(path)!r}).read()[-40:])"
        notebook["cells"].insert(
            0,
            markdown_cell("x")
            | {"cell_type": "code", "source": reads, "outputs": [], "execution_count": None},
        )
        (mallory / f"{NAME}.ipynb").write_text(json.dumps(notebook))
        root.chmod(0o755)
        code = main(["grade", NAME, "--course", str(course.root)])
        said = capsys.readouterr().err
        result = course.results / NAME / "mallory.json"
        if result.exists():
            assert CANARY not in "".join(
                json.dumps(c) for c in json.loads(result.read_text())["cells"]
            )
        else:
            assert code == 2
            assert str(folder) in said or "shown" in said
    finally:
        shutil.rmtree(root)


@soak
def test_nothing_that_links_lead_to_comes_back(released, tmp_path):
    """By nbgrader's own commands too: a link beside a notebook is not followed into feedback."""
    with place(tmp_path / "course", released) as here:
        course = here.course
        folder = course.submitted / "mallory" / NAME
        here.hand_in("mallory", here.notebook())
        for name, target in {
            "notes.txt": course.bundle / f"{NAME}.json",
            "key.txt": course.root / "home/.ssh/id_ed25519",
        }.items():
            (folder / name).symlink_to(target)
        program = Path(sys.executable).with_name("nbgrader")
        env = dict(os.environ, PYTHONPATH=str(ROOT), PATH=f"{program.parent}:{os.environ['PATH']}")
        for verb in ("autograde", "generate_feedback"):
            subprocess.run(
                [program, verb, NAME, "--student", "mallory"],
                cwd=course.root,
                env=env,
                capture_output=True,
            )
        given = [p for p in (course.root / "feedback" / "mallory").rglob("*") if p.is_file()]
        assert not [p for p in given if CANARY in p.read_text(errors="replace")]
