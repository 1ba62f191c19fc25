"""What is pinned can be installed where the README says so."""

import re
from importlib.metadata import distributions
from pathlib import Path

from packaging.specifiers import SpecifierSet
from packaging.utils import canonicalize_name

PINS = Path(__file__).parents[1] / "constraints.txt"
OLDEST = "3.11.2"  # Debian 12's own Python
WHERE = re.compile(r"^([\w.-]+)==(\S+)$", re.MULTILINE)


def test_every_pinned_package_runs_on_the_oldest_python():
    """A package may not ask for a later Python 3.11 than Debian 12 has."""
    pinned = {canonicalize_name(name) for name, _ in WHERE.findall(PINS.read_text())}
    needs = {
        canonicalize_name(found.metadata["Name"]): found.metadata["Requires-Python"] or ""
        for found in distributions()
    }
    assert len(pinned & set(needs)) > 100
    assert not {
        name: needs[name]
        for name in pinned & set(needs)
        if not SpecifierSet(needs[name]).contains(OLDEST)
    }


def test_what_is_installed_is_what_is_pinned():
    """No package is here in another version than everybody else gets."""
    here = {canonicalize_name(x.metadata["Name"]): x.version for x in distributions()}
    pins = {canonicalize_name(name): version for name, version in WHERE.findall(PINS.read_text())}
    assert not {
        name: (here[name], version)
        for name, version in pins.items()
        if name in here and here[name] != version
    }


def test_no_pin_names_an_index():
    """Versions stand there and nothing else: no address, no path."""
    lines = [x for x in PINS.read_text().splitlines() if x and not x.startswith("#")]
    assert all(WHERE.fullmatch(line) for line in lines), lines
