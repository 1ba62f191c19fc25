"""The command that makes a sandbox: bubblewrap, and the part of the disk that it shows.

A sandbox sees, read-only, the folders with the system's programs and libraries, those of each
Python involved (a virtual environment and the one from which it was made), the system's fonts, and
labkit.  It does not see the rest of the disk, such as ``/usr/share``, ``/opt`` and ``/home``.  If a
course or a checkout is within a folder that is shown, an empty folder covers it.
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
"""The parts that are shown of the system, of ``/usr`` and of each Python."""
_HUGE_PAGES = "/sys/kernel/mm/transparent_hugepage"
"""Where the C library reads about pages of 2 MB; hidden before anything is forked."""
_ALSO_SHOWN = ("/usr/share/fonts", "/etc/ld.so.cache", "/etc/alternatives", _HUGE_PAGES)
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
"""The variables inside; the last two put what is loaded on pages of 2 MB, from glibc 2.35 on.

Each question is answered by a fork, which copies the page table, so larger pages save time: a
submission of four questions takes 0.88 of the processor time that it takes without the two
variables, and 0.95 with the first alone, as Python's own allocator does not ask for large pages.
"""


class NoIsolation(LabkitError):
    """This machine cannot isolate a student's code; the message says what to do."""


class Isolation(Enum):
    """What isolates a student's code, in words; the code that starts a sandbox chooses."""

    BUBBLEWRAP = "bubblewrap"
    USER = "no bubblewrap but a user id"
    NONE = "none (asked for by --unsafe-no-isolation)"


def command(isolation: Isolation, hidden: Iterable[Path]) -> tuple[list[str], dict[str, str]]:
    """The command that starts the forkserver, and its environment.

    Args:
        isolation: What isolates the children of the forkserver.
        hidden: Folders that must not be visible inside; only bubblewrap can hide them.

    Raises:
        NoIsolation: This machine does not have this isolation.
    """
    match isolation:
        case Isolation.BUBBLEWRAP:
            return bubblewrap_command(hidden)
        case Isolation.USER:
            return user_command()
        case Isolation.NONE:
            return bare_command()


def bubblewrap_command(hidden: Iterable[Path] = ()) -> tuple[list[str], dict[str, str]]:
    """The command that makes a sandbox with the forkserver in it, and bubblewrap's environment.

    Args:
        hidden: Folders that must not be visible inside, such as the course's.

    Raises:
        NoIsolation: Bubblewrap is missing, or there is no filter for this processor.
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
    words += mount_arguments(python_paths(), [*hidden, *_checkout()])
    words += ["--perms", "0755", "--dir", _LAB, "--ro-bind", str(_PACKAGE), f"{_LAB}/labkit"]
    words += ["--ro-bind", str(_font_list()), f"{_LAB}/mpl"]
    for name, value in _INSIDE.items():
        words += ["--setenv", name, value]
    words += ["--remount-ro", "/dev", "--remount-ro", "/", "--chdir", "/", *_FORKSERVER]
    return words, {"PATH": os.environ.get("PATH", "/usr/bin:/bin")}


def user_command() -> tuple[list[str], dict[str, str]]:
    """The command that starts the forkserver for isolation by user id, and its environment.

    Raises:
        NoIsolation: This is not root, or there is no filter for this processor.
    """
    if os.geteuid():
        raise NoIsolation("only root can give a student's code another user id; run it as root")
    if not seccomp.supported():
        raise NoIsolation("no system call filter for this processor; grade on x86-64 or arm64")
    more = {"PYTHONPATH": str(_PACKAGE.parent), "MPLCONFIGDIR": str(_font_list())}
    return [*_FORKSERVER, "--by-user"], _INSIDE | more


def bare_command() -> tuple[list[str], dict[str, str]]:
    """The command that starts the forkserver without a sandbox, and its environment."""
    variables = {**os.environ, **_VARIABLES, "PYTHONPATH": str(_PACKAGE.parent)}
    return [*_FORKSERVER, "--bare"], variables


def python_paths() -> list[Path]:
    """The paths that must be shown so that Python and its packages work."""
    program = Path(sys.executable)
    prefixes = {Path("/"), Path("/usr"), Path("/usr/local")}
    prefixes |= {Path(sys.prefix), Path(sys.base_prefix), program.parents[1]}
    while program.is_symlink():  # from a virtual environment to its Python
        program = Path(os.path.normpath(program.parent / os.readlink(program)))
        prefixes.add(program.parents[1])
    places = [*(prefix / part for prefix in prefixes for part in _PARTS), *map(Path, _ALSO_SHOWN)]
    return sorted(place for place in places if place.exists())


def mount_arguments(shown: Iterable[Path], hidden: Iterable[Path]) -> list[str]:
    """Bubblewrap's arguments for a disk that shows some places and nothing else.

    Args:
        shown: Places to show, read-only; a link stays a link, and its target is shown, too.
        hidden: Folders that are empty inside, even within one that is shown; a place to show
            within a hidden folder is shown.
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
    """The path of a place without symbolic links; those on the way are added to ``links``."""
    for above in (*reversed(place.parents), place):
        if above.is_symlink():
            links[above] = os.readlink(above)
            target = Path(os.path.normpath(above.parent / links[above]))
            return _without_links(target / place.relative_to(above), links)
    return place


def _folders(folder: Path, made: set[Path]) -> Iterator[str]:
    """Arguments that make parent folders readable; by default, only root could enter them."""
    for above in (*reversed(folder.parents), folder):
        if above not in made and above not in {Path("/"), Path("/tmp"), Path("/dev")}:
            yield from ("--perms", "0755", "--dir", str(above))
            made.add(above)


def _checkout() -> Sequence[Path]:
    """The folder that contains labkit, if it is a course with its solutions."""
    around = _PACKAGE.parent
    return [around] if (around / "nbgrader_config.py").exists() else []


def _font_list() -> Path:
    """The folder with Matplotlib's list of fonts, made once because that takes long."""
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
