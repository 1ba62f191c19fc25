"""The committed browser files are the ones that were made, from the sources that are here."""

import hashlib
import json
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
