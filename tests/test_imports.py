"""Imports point one way, keep foreign libraries to their modules, and stay quick."""

import ast
import graphlib
import os
import subprocess
import sys
from pathlib import Path

import pytest
from count import LARGE, lines

ROOT = Path(__file__).parents[1]
LABKIT = ROOT / "labkit"
FILES = sorted(LABKIT.rglob("*.py"))

ORDER = [
    {"errors", "quiet"},
    {"shapes", "formats"},
    {"se3"},
    {"trajectory"},
    {"paths"},
    {"plant"},
    {"urdf"},
    {"robot"},
    {"baxter"},
    {"kinematics"},
    {"model"},
    {"control"},
    {"joints", "sim.engine"},
    {"sim.pybullet", "sim.mujoco", "sim"},
    {"world"},
    {"scene"},
    {"sensors", "springs"},
    {"motors"},
    {"arm"},
    {"log", "arm_adapters"},
    {"run"},
    {"metrics", "recordings", "stability"},
    {"tags.tag", "tags.intrinsics", "tags.estimation", "tags.surface"},
    {"tags.edges", "tags.board", "tags.visuals", "tags.rendering"},
    {"tags.paper"},
    {"tags.camera"},
    {"tags.detection"},
    {"tags.stream"},
    {"tags"},
    {"replay.figure"},
    {"replay.saved"},
    {"plotting"},
    {"replay.motion", "replay.surroundings"},
    {
        "replay.recorded",
        "replay.dials",
        "replay.hand",
        "replay.pacer",
        "replay.pull",
        "replay.watch",
    },
    {"replay.session"},
    {"replay.front"},
    {"replay.widget"},
    {"replay.view"},
    {"replay"},
    {"labkit"},
    {
        "course.verdict",
        "course.scopes",
        "course.advice",
        "course.calling",
        "course.seed",
    },
    {"course.source"},
    {"course.forms"},
    {"course.judges", "course.withheld", "course.unfinished", "course.stand_ins"},
    {"course.bugs"},
    {"course.own_arm"},
    {"course.equivalence"},
    {"course.question"},
    {"course.differences"},
    {"course.brief", "course.serialize", "course.messages"},
    {"course.predictions", "course.identification"},
    {"course.reply", "course.notebook", "course.card", "course.checks_file"},
    {"course.gaps", "course.marking", "course.probes"},
    {"course.definitions"},
    {"course.relations"},
    {"course.observed"},
    {"course.student"},
    {
        "course.before_handing_in",
    },
    {"course.merge", "course.receipt", "course.reveal"},
    {"course.cli"},
    {"course"},
    {"course.authoring", "course.authoring.problem", "course.authoring.outcomes"},
    {"course.authoring.layout", "course.authoring.solved", "course.authoring.refusals"},
    {"course.authoring.bundle", "course.authoring.margins"},
    {"course.authoring.release", "course.authoring.report_card"},
]
"""Lab and course from the ground up; each module imports from sets before its own alone."""
LEVEL = {name: i for i, names in enumerate(ORDER) for name in names}
FOLDERS = [
    *("sandbox", "", "grading", "nbgrader", "students", "marks", "feedback"),
    *("defence", "terms", "gradescope", "commands"),
]
"""The grader's folders from the ground up; "" is `labkit/grader` itself, which all others share."""
UPSTAIRS = {"grader", "__main__"}
"""The grader and the command line, which neither lab nor course knows."""
# What simulates, what knows the equations, what draws and what sees.
MODEL = {"kinematics", "model", "se3", "urdf"}
DRAW = {"plotting", "replay", "grader.feedback.drawing", "course.reveal"}
SEE = {
    "tags.rendering",
    "tags.tag",
    "tags.detection",
    "tags.edges",
    "tags.camera",
    "tags.intrinsics",
}


def names(path):
    """Its names below labkit, widest first: labkit/replay/page.py is replay and replay.page."""
    parts = path.relative_to(LABKIT).with_suffix("").parts
    return [".".join(parts[: k + 1]) for k in range(len(parts))]


def imported(path):
    """Every module that a file imports, at its head or later, in full, with its line."""
    package = ("labkit", *path.relative_to(LABKIT).parent.parts)
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from ((alias.name, node.lineno) for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else ()
            stem = ".".join([*base, *([node.module] if node.module else [])])
            yield stem, node.lineno
            if stem == "labkit" or node.level:
                yield from ((f"{stem}.{alias.name}", node.lineno) for alias in node.names)


def where(path, line):
    return f"{path.relative_to(ROOT)}:{line}"


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(LABKIT)))
def test_labkit_never_imports_the_answers_nor_the_tests(path):
    """No file of labkit imports solutions, tests or book, not even inside a function."""
    for name, line in imported(path):
        assert name.split(".")[0] not in ("solutions", "tests", "book"), where(path, line)


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(LABKIT)))
def test_foreign_libraries_stay_in_their_modules(path):
    """Only its owners import a library that has owners, and no module ompl or toppra."""
    owners = {
        "pybullet": {"sim.pybullet"}, "mujoco": {"sim.mujoco"}, "pinocchio": MODEL,
        "matplotlib": DRAW, "anywidget": DRAW, "ompl": set(), "toppra": set(),
        "cv2": SEE, "nbgrader": {"grader"},
    }  # fmt: skip
    for name, line in imported(path):
        allowed = owners.get(name.split(".")[0])
        if allowed is not None and not allowed & set(names(path)):
            pytest.fail(f"{where(path, line)}: only {', '.join(sorted(allowed))} may import {name}")


def place(name):
    """The module in an imported name below labkit: "tags" of "tags.Board", "labkit" of "Arm"."""
    while name and name not in MODULES:
        name = name.rpartition(".")[0]
    return name or "labkit"


def module(path):
    """A file's name below labkit, as ORDER has it: "tags.board", "tags", "labkit"."""
    return names(path)[-1].removesuffix("__init__").rstrip(".") or "labkit"


MODULES = {module(path) for path in FILES}
BELOW = [path for path in FILES if names(path)[0] not in UPSTAIRS]


@pytest.mark.parametrize("path", BELOW, ids=lambda p: str(p.relative_to(LABKIT)))
def test_imports_point_one_way(path):
    """Each module of lab and course has a place, and imports only what is below it."""
    here = module(path)
    assert here in LEVEL, f"{here} has no place in the order"
    for name, line in imported(path):
        root, _, rest = name.partition(".")
        other = place(rest) if root == "labkit" else here
        if other == here or (other == "labkit" and not rest):
            continue
        if other == "labkit" and here != "labkit":
            pytest.fail(f"{where(path, line)}: {here} imports {name} from the package itself")
        assert other in LEVEL, f"{where(path, line)}: {here} may not import {other}"
        assert LEVEL[other] < LEVEL[here], f"{where(path, line)}: {here} imports {other}"


def test_no_modules_import_each_other_in_a_circle():
    """Nor in the grader, nor late, nor for a type alone."""
    below = {}
    for path in FILES:
        found = {place(name.partition(".")[2]) for name, _ in imported(path) if "labkit." in name}
        below[module(path)] = found - {module(path), "labkit", "grader", "course"}
    graphlib.TopologicalSorter(below).prepare()


GRADER = [path for path in FILES if names(path)[0] == "grader"]


def folder(name):
    """The folder of one of the grader's modules: "marks" of "grader.marks.table"."""
    first = f"{name}.".split(".")[1]
    return first if first in FOLDERS else ""


@pytest.mark.parametrize("path", GRADER, ids=lambda p: str(p.relative_to(LABKIT)))
def test_the_graders_folders_import_one_way(path):
    """Each module of the grader imports from its own folder and from folders below it alone."""
    here = FOLDERS.index(folder(module(path)))
    for name, line in imported(path):
        root, _, rest = name.partition(".")
        if root == "labkit" and place(rest).startswith("grader."):
            below = folder(place(rest))
            assert FOLDERS.index(below) <= here, f"{where(path, line)}: may not import {below}"


def test_the_order_names_modules_that_exist():
    """A module that has gone leaves the order too."""
    assert set(LEVEL) == {module(path) for path in BELOW}


def test_labkit_offers_at_most_45_names():
    """The list after ``lk.`` and Tab can be read; for a new name another may have to leave."""
    import labkit as lk

    assert len(lk.__all__) <= 45


@pytest.mark.parametrize("path", FILES, ids=lambda p: str(p.relative_to(LABKIT)))
def test_no_file_of_labkit_has_more_than_200_lines_of_code(path):
    """As `make count` counts them, without comments and docstrings."""
    assert lines(path.read_text()) <= LARGE == 200


def test_every_name_in_all_exists():
    """Each name in lk.__all__ gives an object, and any other name is an AttributeError."""
    import labkit as lk

    for name in lk.__all__:
        assert getattr(lk, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'Robot9'"):
        _ = lk.Robot9


def python(program):
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        [sys.executable, "-c", program],
        capture_output=True,
        text=True,
        timeout=600,
        env=environment,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_a_public_name_means_the_same_whichever_module_was_loaded_first():
    """A name loaded late may not be hidden by a module of the same name."""
    kind = "lambda: {name: type(getattr(labkit, name)).__name__ for name in labkit.__all__}"
    modules = ", ".join(
        f"labkit.{path.stem}" for path in LABKIT.glob("*.py") if not path.stem.startswith("_")
    )
    alone = python(f"import labkit; print(({kind})())")
    assert python(f"import labkit, {modules}; print(({kind})())") == alone


def test_completion_offers_what_is_not_loaded_yet():
    """What a notebook shows after ``lk.`` and Tab."""
    assert python("import labkit; print(*set(labkit.__all__) - set(dir(labkit)))").split() == []


def test_importing_labkit_loads_no_drawing_nor_notebook_package():
    """After `import labkit` none of eleven heavy packages is loaded, such as matplotlib."""
    loaded = python("import sys, labkit; print(*sys.modules)").split()
    heavy = {"matplotlib", "IPython", "anywidget", "ipywidgets", "cv2", "scipy", "control",
             "nbgrader", "pandas", "ompl", "toppra"}  # fmt: skip
    assert not heavy & {name.split(".")[0] for name in loaded}


def test_drawing_a_run_does_not_load_what_analyses_a_loop():
    """python-control takes longer to load than all that draws."""
    assert "control" not in python("import sys, labkit.plotting; print(*sys.modules)").split()
