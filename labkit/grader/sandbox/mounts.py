"""The command that makes a sandbox: bubblewrap, and what it shows of the disk.

Shown, read-only, are the folders with the system's programs and libraries, those of each Python
that takes part (a virtual environment and what it was made from), the system's fonts, and labkit.
The rest of the disk is not there: no ``/usr/share``, no ``/opt``, no ``/home``.  Where a course or
a checkout is inside a shown folder, an empty one covers it.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Iterable, Iterator, Sequence
from enum import Enum
from pathlib import Path

import labkit

from ...errors import LabkitError
from . import seccomp
from .confine import DEVICES

INSTALL = "apt-get install bubblewrap"
_PACKAGE = Path(labkit.__file__).parent
_LAB = "/lab"
_PARTS = ("bin", "lib", "lib32", "lib64", "pyvenv.cfg")
"""What is shown of the system, of ``/usr`` and of each Python."""
_HUGE_PAGES = "/sys/kernel/mm/transparent_hugepage"
"""What the C library asks about pages of 2 MB; covered before anything is forked."""
_MORE = ("/usr/share/fonts", "/etc/ld.so.cache", "/etc/alternatives", _HUGE_PAGES)
_FORKSERVER = (sys.executable, "-P", "-s", "-m", "labkit.grader.sandbox.forkserver")
_VARIABLES = {
    "PYTHONHASHSEED": "0",
    "PYTHONDONTWRITEBYTECODE": "1",
    "MPLBACKEND": "Agg",
    "OPENBLAS_NUM_THREADS": "1",
    "OMP_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "LC_ALL": "C.UTF-8",
    "IPYTHONDIR": "/tmp/ipython",
}
_INSIDE = _VARIABLES | {
    "PATH": "/usr/bin:/bin",
    "HOME": "/tmp",
    "PYTHONPATH": _LAB,
    "MPLCONFIGDIR": "/tmp/mpl",
    "GLIBC_TUNABLES": "glibc.malloc.hugetlb=1",
    "PYTHONMALLOC": "malloc",
}
"""The last two put what is loaded on pages of 2 MB (glibc 2.35 or newer; else they do nothing).

Each question is answered by forks, which copy the table of all pages: a submission of four
questions takes 0.88 of the processor time that it takes without the two, and 0.95 with the first
alone, as Python's own allocator asks for no such pages.
"""


class NoIsolation(LabkitError):
    """This machine cannot keep a student's code apart; the sentence says how it could."""


class Isolation(Enum):
    """What keeps a student's code apart, in words; chosen by the code that starts a sandbox."""

    BUBBLEWRAP = "bubblewrap"
    USER = "no bubblewrap but a user id"
    NONE = "none (asked for by --unsafe-no-isolation)"


def command(isolation: Isolation, hidden: Iterable[Path]) -> tuple[list[str], dict[str, str]]:
    """The command that starts the forkserver, and its environment.

    Args:
        isolation: What keeps its children apart.
        hidden: Folders of which nothing may be seen inside; bubblewrap alone can hide them.

    Raises:
        NoIsolation: It cannot be had here.
    """
    match isolation:
        case Isolation.BUBBLEWRAP:
            return isolated(hidden)
        case Isolation.USER:
            return by_user()
        case Isolation.NONE:
            return bare()


def isolated(hidden: Iterable[Path] = ()) -> tuple[list[str], dict[str, str]]:
    """The command that makes a sandbox with the forkserver in it, and bubblewrap's environment.

    Args:
        hidden: Folders of which nothing may be seen inside, such as the course's.

    Raises:
        NoIsolation: There is no bubblewrap, or no filter for this processor.
    """
    program = shutil.which("bwrap")
    if program is None:
        raise NoIsolation(f"bubblewrap is missing; get it with: {INSTALL}")
    if not seccomp.supported():
        raise NoIsolation("no system call filter for this processor; grade on x86-64 or arm64")
    words = [program, "--unshare-ipc", "--unshare-pid", "--unshare-net", "--unshare-uts"]
    words += ["--unshare-cgroup-try", "--die-with-parent", "--new-session", "--clearenv"]
    if os.geteuid():
        words += ["--unshare-user", "--uid", "0", "--gid", "0"]
    for capability in ("SYS_ADMIN", "SETUID", "SETGID", "SETPCAP", "KILL"):
        words += ["--cap-add", f"CAP_{capability}"]
    words += ["--perms", "1777", "--tmpfs", "/tmp", "--perms", "0755", "--tmpfs", "/dev"]
    for device in DEVICES:
        words += ["--dev-bind", device, device]
    words += ["--dir", "/dev/shm", "--proc", "/proc"]
    words += view(needed(), [*hidden, *_checkout()])
    words += ["--perms", "0755", "--dir", _LAB, "--ro-bind", str(_PACKAGE), f"{_LAB}/labkit"]
    words += ["--ro-bind", str(_font_list()), f"{_LAB}/mpl"]
    for name, value in _INSIDE.items():
        words += ["--setenv", name, value]
    words += ["--remount-ro", "/dev", "--remount-ro", "/", "--chdir", "/", *_FORKSERVER]
    return words, {"PATH": os.environ.get("PATH", "/usr/bin:/bin")}


def by_user() -> tuple[list[str], dict[str, str]]:
    """The command that starts the forkserver for `by_user`, and its environment.

    Raises:
        NoIsolation: This is not root, or there is no filter for this processor.
    """
    if os.geteuid():
        raise NoIsolation("only root can give a student's code another user id; run it as root")
    if not seccomp.supported():
        raise NoIsolation("no system call filter for this processor; grade on x86-64 or arm64")
    more = {"PYTHONPATH": str(_PACKAGE.parent), "MPLCONFIGDIR": str(_font_list())}
    return [*_FORKSERVER, "--by-user"], _INSIDE | more


def bare() -> tuple[list[str], dict[str, str]]:
    """The command that starts the forkserver without a sandbox, and its environment."""
    variables = {**os.environ, **_VARIABLES, "PYTHONPATH": str(_PACKAGE.parent)}
    return [*_FORKSERVER, "--bare"], variables


def needed() -> list[Path]:
    """What must be shown for Python and its packages to work."""
    program = Path(sys.executable)
    prefixes = {Path("/"), Path("/usr"), Path("/usr/local")}
    prefixes |= {Path(sys.prefix), Path(sys.base_prefix), program.parents[1]}
    while program.is_symlink():  # a virtual environment's, which leads to the one it was made from
        program = Path(os.path.normpath(program.parent / os.readlink(program)))
        prefixes.add(program.parents[1])
    places = [*(prefix / part for prefix in prefixes for part in _PARTS), *map(Path, _MORE)]
    return sorted(place for place in places if place.exists())


def view(shown: Iterable[Path], hidden: Iterable[Path]) -> list[str]:
    """Bubblewrap's words for a disk on which some places are shown and nothing else is.

    Args:
        shown: To be seen, read-only; a link stays a link, and what it leads to is shown too.
        hidden: Folders that are empty inside, even within a shown one; a shown place within a
            hidden folder is shown.
    """
    links: dict[Path, str] = {}
    kinds = {_without_links(place, links): "show" for place in shown}
    kinds |= {place.resolve(): "hide" for place in hidden}
    words: list[str] = []
    covers: list[str] = []
    made: set[Path] = set()
    done: dict[Path, str] = {}
    for place in sorted(kinds, key=lambda place: len(place.parts)):
        around = next((done[above] for above in place.parents if above in done), "hide")
        if kinds[place] == around:
            continue
        done[place] = kinds[place]
        if around == "hide":
            words += [*_folders(place.parent, made), "--ro-bind", str(place), str(place)]
        else:
            words += ["--perms", "0755", "--tmpfs", str(place)]
            covers += ["--remount-ro", str(place)]
            made.add(place)
    for link, target in links.items():
        if "show" not in (done.get(above) for above in link.parents):
            words += [*_folders(link.parent, made), "--symlink", target, str(link)]
    return words + covers


def _without_links(place: Path, links: dict[Path, str]) -> Path:
    """The place without links on the way to it; those that were there are noted."""
    for above in (*reversed(place.parents), place):
        if above.is_symlink():
            links[above] = os.readlink(above)
            target = Path(os.path.normpath(above.parent / links[above]))
            return _without_links(target / place.relative_to(above), links)
    return place


def _folders(folder: Path, made: set[Path]) -> Iterator[str]:
    """Make the folders above a place, readable: bubblewrap would close them to all but root."""
    for above in (*reversed(folder.parents), folder):
        if above not in made and above not in {Path("/"), Path("/tmp"), Path("/dev")}:
            yield from ("--perms", "0755", "--dir", str(above))
            made.add(above)


def _checkout() -> Sequence[Path]:
    """The folder around labkit, where that is a course with its solutions."""
    around = _PACKAGE.parent
    return [around] if (around / "nbgrader_config.py").exists() else []


def _font_list() -> Path:
    """Where Matplotlib keeps its list of fonts; made once, as that takes a while."""
    base = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
    folder = base / "labkit" / "matplotlib"
    if not any(folder.glob("fontlist*")):
        folder.mkdir(parents=True, exist_ok=True)
        subprocess.run(
            [sys.executable, "-P", "-c", "import matplotlib.font_manager"],
            env=dict(os.environ) | {"MPLCONFIGDIR": str(folder)},
            check=False,
            capture_output=True,
        )
    return folder
