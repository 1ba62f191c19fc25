"""Nobody is taken for somebody else, whatever they call themselves or their files.

Ada Lovelace is participant 42 (Canvas: user 42; exchange: `ada`), and her work has been collected
before.  Eve is participant 77 and hands in a file in each of these attacks.
"""

from __future__ import annotations

import os
import re

import pytest
from downloaded import NAME, bare_course, counting, kept, zipped

from labkit.__main__ import main
from labkit.grader.collect import participants

M = "_assignsubmission_file_"
FIRST = {
    "moodle": f"Ada Lovelace_42{M}{NAME}.ipynb",
    "canvas": f"lovelaceada_42_900_{NAME}.ipynb",
}
_UNSAFE = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028-\u202e]")


def _write(folder, course):
    (folder / f"{NAME}.ipynb").write_text("eve")


def _link_folder(folder, course):
    folder.rmdir()
    folder.symlink_to(course / f"submitted/ada/{NAME}")


def _link_file(folder, course):
    (folder / f"{NAME}.ipynb").symlink_to(course / f"submitted/ada/{NAME}/{NAME}.ipynb")


def _hard_link(folder, course):
    os.link(course / "solution.ipynb", folder / f"{NAME}.ipynb")


def _link_secret(folder, course):
    _write(folder, course)
    (folder / "submission_secret.txt").symlink_to(course / "solution.ipynb")


MOODLES = (
    f"Eve Mallory_77{M}x_42{M}01_curves(9).ipynb",
    f"Eve Mallory_77{M}_42{M}01_curves.ipynb",
    f"Eve Mallory_77{M}Ada Lovelace_42{M}01_curves.ipynb",
    f"Eve Mallory_77{M}x_42{M}y_42{M}01_curves.ipynb",
    f"Eve Mallory_77{M}/Ada Lovelace_42{M}01_curves.ipynb",
    f"Eve Mallory_77{M}/Ada Lovelace_42{M}/01_curves.ipynb",
    f"Eve Mallory_77{M}..\\Ada Lovelace_42{M}01_curves.ipynb",
    f"Eve Mallory_77{M}/../../Ada-Lovelace/01_curves/01_curves.ipynb",
    f"Ada Lovelace_77{M}01_curves.ipynb",
    f"Ada\u00a0 Lovelace_77{M}01_curves.ipynb",
    f"Ada-Lovelace_77{M}01_curves.ipynb",
    f"ada lovelace_77{M}01_curves.ipynb",
    f"Ada Lovelace 42_77{M}01_curves.ipynb",
    f"Ada Lovelace-42_77{M}01_curves.ipynb",
    f"Ada-Lovelace-42_77{M}01_curves.ipynb",
    f"Bob\x1b]0;owned\x07_77{M}\x1b[2J.ipynb",
    f"Eve_77{M}x.ipynb\nAda-Lovelace: 01_curves.ipynb: taken.ipynb",
    f"{'E' * 300}_77{M}{'x' * 300}.ipynb",
    f"..._77{M}01_curves.ipynb",
)
CANVASES = (
    "malloryeve_77_901_lovelaceada_42_900_01_curves.ipynb",
    "malloryeve_LATE_77_901_42_900_01_curves.ipynb",
    "lovelaceada_77_901_01_curves.ipynb",
)
EXCHANGES = (
    ("ada+01_curves+2030-01-01 00:00:00 UTC+x", _write),
    ("ada+01_curves+2030-01-01 00:00:00 UTC", _write),
    ("Ada+01_curves+2030-01-01 00:00:00 UTC+x", _write),
    ("ada +01_curves+2030-01-01 00:00:00 UTC+x", _write),
    ("ada+01_curves+2030-01-01 00:00:00 UTC+y", _link_folder),
    ("ada+01_curves+2030-01-01 00:00:00 UTC+z", _link_file),
    ("ada+01_curves+2030-01-01 00:00:00 UTC+h", _hard_link),
    ("ada+01_curves+2030-01-01 00:00:00 UTC+s", _link_secret),
)
IMPOSTORS = [
    *(("moodle", name, _write) for name in MOODLES),
    *(("canvas", name, _write) for name in CANVASES),
    *(("exchange", *each) for each in EXCHANGES),
]
"""The platform, the name of the file or folder, and how a file gets into the exchange."""


@pytest.mark.parametrize(("system", "name", "put"), IMPOSTORS)
def test_nobody_is_taken_for_another(tmp_path, capsys, system, name, put):
    """Ada's work stays hers under her number, and nothing of Eve's is hers, not even kept."""
    where = tmp_path / "course"
    course = bare_course(where)
    (course.root / "solution.ipynb").write_text("the solution")
    first = zipped(tmp_path / "1.zip", [(FIRST.get(system, FIRST["moodle"]), "ada")])
    assert main(["collect", NAME, str(first), "--course", str(where)]) == 0
    assert counting(course) == {"ada": "ada"}
    if system == "exchange":
        source = tmp_path / "inbound"
        (source / name).mkdir(parents=True)
        put(source / name, course.root)
    else:
        entries = [(FIRST[system], "ada"), (name, "eve")]
        source = zipped(tmp_path / "2.zip", entries, (2030, 1, 1, 12, 0, 0))
    around = {*tmp_path.iterdir()}
    capsys.readouterr()
    code = main(["collect", NAME, str(source), "--course", str(where)])
    out, err = capsys.readouterr()
    assert code in (0, 1, 2) and not _UNSAFE.search(out + err)
    assert counting(course)["ada"] == "ada" and kept(course, "ada") == {"ada"}
    assert set(counting(course)) <= {"ada", "eve"}
    numbers = participants(course).get(NAME, {})
    assert numbers.get("ada", "42") == "42" and numbers.get("eve", "77") == "77"
    assert {*tmp_path.iterdir()} == around
    files = [*course.submitted.rglob("*")]
    assert not [p for p in files if p.is_symlink() or (p.is_file() and p.stat().st_nlink > 1)]
