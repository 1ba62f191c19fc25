"""The committed browser files are the ones that were made, from the sources that are here."""

import hashlib
import json
import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
VENDOR = ROOT / "book/static/vendor"
MANIFEST = json.loads((VENDOR / "MANIFEST.json").read_text())
AGAIN = "run `sh book/_tools/vendor.sh` (node 20, npm) and commit what it writes"


def sha256(name):
    return hashlib.sha256((ROOT / name).read_bytes()).hexdigest()


def test_committed_files_have_the_recorded_hashes():
    """Each file of the manifest exists and has its SHA-256."""
    wrong = [n for n, h in MANIFEST["files"].items() if not (ROOT / n).exists() or sha256(n) != h]
    assert not wrong, f"{wrong} differ from MANIFEST.json; {AGAIN}"


def test_bundle_was_made_from_these_sources():
    """No source of the viewer, of the live pages or of the bundler changed, came or went since."""
    folders = ("labkit/replay/viewer", "book/_tools/vendor", "book/live")
    here = {
        str(p.relative_to(ROOT))
        for f in folders
        for p in (ROOT / f).rglob("*")
        if p.is_file() and "bundle" not in p.parts
    }
    changed = {n for n in here | set(MANIFEST["sources"])
               if n not in here or MANIFEST["sources"].get(n) != sha256(n)}  # fmt: skip
    assert not changed, f"{sorted(changed)} changed since the bundle was made; {AGAIN}"


def test_nothing_unrecorded_lies_among_them():
    """Both folders hold only recorded files, and the manifest itself."""
    folders = (VENDOR, ROOT / "book/live/bundle")
    here = {str(p.relative_to(ROOT)) for f in folders for p in f.rglob("*") if p.is_file()}
    assert here - set(MANIFEST["files"]) == {"book/static/vendor/MANIFEST.json"}


def test_versions_are_exact_and_no_registry_is_named():
    """Each version is three numbers, the manifest's; there is no lock file and no registry."""
    wanted = json.loads((ROOT / "book/_tools/vendor/package.json").read_text())["dependencies"]
    assert MANIFEST["packages"] == wanted
    assert all(re.fullmatch(r"\d+\.\d+\.\d+", v) for v in wanted.values())
    assert not list((ROOT / "book/_tools/vendor").glob("*lock*"))
    for folder in ("book/_tools/vendor", "labkit/replay/viewer"):
        for path in (ROOT / folder).rglob("*"):
            assert "registry" not in path.read_text() if path.is_file() else True, path


def test_each_package_brings_its_licence():
    """The licences of the bundled packages, with MuJoCo's notice, and of Baxter's data exist."""
    names = {p.name for p in VENDOR.glob("LICENSE-*")}
    assert {
        "LICENSE-mathjax",
        "LICENSE-requirejs",
        "LICENSE-html-manager",
        "LICENSE-anywidget",
    } <= names
    assert (ROOT / "labkit/data/viewer/LICENSE-three").exists()
    assert (ROOT / "tests/vendor/LICENSE-axe").exists()
    bundle = ROOT / "book/live/bundle"
    assert "Apache License" in (bundle / "LICENSE-mujoco").read_text()
    assert (bundle / "NOTICE-mujoco.md").exists()
    assert "Rethink Robotics" in (ROOT / "labkit/data/LICENSE-baxter").read_text()
