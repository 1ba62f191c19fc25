"""What is pinned can be installed where the README says so."""

import re
import sysconfig
from importlib.metadata import distributions
from pathlib import Path

from packaging.specifiers import SpecifierSet

PINS = Path(__file__).parents[1] / "constraints.txt"
OLDEST = "3.11.2"  # Debian 12's own Python
WHERE = re.compile(r"^([\w.-]+)==(\S+)$", re.MULTILINE)


def pinned():
    """Name, version and metadata of every pinned package that is installed here."""
    here = {
        sysconfig.get_path(name) for name in ("purelib", "platlib")
    }  # not what setuptools hides
    there = {
        _plain(found.metadata["Name"]): found.metadata for found in distributions(path=[*here])
    }
    for name, version in WHERE.findall(PINS.read_text()):
        if _plain(name) in there:
            yield name, version, there[_plain(name)]


def _plain(name):
    """A package's name as indexes compare it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def test_every_pinned_package_runs_on_the_oldest_python():
    """A package may not ask for a later Python 3.11 than Debian 12 has."""
    needs = {name: about.get("Requires-Python") or "" for name, _, about in pinned()}
    assert len(needs) > 100
    assert not {x: need for x, need in needs.items() if OLDEST not in SpecifierSet(need)}


def test_what_is_installed_is_what_is_pinned():
    """No package is here in another version than everybody else gets."""
    assert not {
        name: (about["Version"], version)
        for name, version, about in pinned()
        if about["Version"] != version
    }


def test_no_pin_names_an_index():
    """The list holds versions and nothing else: no address, no path."""
    lines = [x for x in PINS.read_text().splitlines() if x and not x.startswith("#")]
    assert all(WHERE.fullmatch(line) for line in lines), lines
