"""Start the lab: `python3 start.py` installs what the notebooks need, once, and opens them.

On Windows it is `py start.py`.  Any Python from 3.8 on will do: uv, which pip fetches, finds a
Python for the lab or fetches one.  Everything goes into the folders ``.venv`` and ``.tools`` beside
this file; delete them to start from the beginning.  `start.py install` opens no notebook.
"""

# An old Python must be able to read this file, so that it can be told that it is too old.
import hashlib
import json
import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

HERE = Path(__file__).resolve().parent
TOOLS = HERE / ".tools"
ENV = HERE / ".venv"
DONE = ENV / "made_for.txt"
CACHE = HERE / ".fetched"
LOG = HERE / "install.log"
PYTHONS = ">=3.11,<3.15"
FREE = 1.6e9
SIZE = 1.1e9
"""Bytes of all packages, unpacked."""
NO_NETWORK = ("error sending request", "dns error", "Failed to fetch", "NewConnectionError",
              "NameResolution", "timed out", "ProxyError")  # fmt: skip


class Stop(Exception):
    """The reason why this program cannot continue, as a sentence."""


def main(words):
    """Make the environment if there is none, and open the notebooks."""
    if words not in ([], ["install"]):
        raise Stop("type start.py alone to open the notebooks, or start.py install to prepare them")
    wanted = version()
    if not (DONE.is_file() and DONE.read_text() == wanted):
        make()
        DONE.write_text(wanted)
    if words == ["install"]:
        return 0
    os.environ["JUPYTERLAB_WORKSPACES_DIR"] = str(ENV / "workspaces")  # no other course's notebooks
    os.environ["PATH"] = str(program(ENV, "python").parent) + os.pathsep + os.environ["PATH"]
    if not os.access(os.path.expanduser("~"), os.W_OK):
        os.environ["HOME"] = str(ENV / "home")
        (ENV / "home").mkdir(exist_ok=True)
    words = ["--log-level=ERROR", "--notebook-dir=" + str(HERE / "assignments")]
    words += ["--KernelManager.transport_encryption=auto"]  # else each kernel prints a warning
    words += ["--LabApp.default_url=/lab/tree/START_HERE.ipynb"]
    words += ["--ServerApp.answer_yes=True"]  # Ctrl-C ends it without a question
    words += ["--allow-root"] if hasattr(os, "geteuid") and os.geteuid() == 0 else []
    print("opening JupyterLab at START_HERE, which takes about ten seconds;", end=" ")
    print("to end it, press Ctrl-C here", flush=True)
    return subprocess.call([str(program(ENV, "python")), "-m", "jupyterlab"] + words)


def make():
    """Make the environment from the beginning; only downloads are kept of an unfinished one."""
    if sys.version_info < (3, 8):
        raise Stop("this Python is too old to begin with; get a newer one from python.org")
    free = shutil.disk_usage(str(HERE)).free
    if free < FREE:
        raise Stop(
            "this disk has {:.1f} GB free, and the lab needs {:.1f} GB while it is installed; "
            "make room, then type the same again".format(free / 1e9, FREE / 1e9)
        )
    print("1 of 3: making an environment in {}".format(ENV), flush=True)
    shutil.rmtree(str(ENV), ignore_errors=True)
    uv = program(TOOLS, "uv")
    if not uv.is_file():
        try:
            import venv

            venv.create(str(TOOLS), with_pip=True)
        except (ImportError, subprocess.CalledProcessError):
            shutil.rmtree(str(TOOLS), ignore_errors=True)
            raise Stop(
                "this Python cannot make environments. Type: sudo apt-get install python{}.{}-venv "
                "(or what your system calls it), then the same again".format(*sys.version_info)
            )
        wait([program(TOOLS, "python"), "-m", "pip", "install", "uv"])
    wait([uv, "venv", "--python", PYTHONS, ENV])
    print("2 of 3: fetching about 300 MB", flush=True)
    words = [
        uv,
        "pip",
        "install",
        "--python",
        program(ENV, "python"),
        "--system-certs",
        "--cache-dir",
        CACHE,
    ]
    words += ["--constraint", HERE / "constraints.txt"]
    wait(words + ["jupyterlab", wheel() + "[notebook]"], SIZE)
    print("3 of 3: moving the arm for the first time, which takes a while", flush=True)
    tidy()
    wait([program(ENV, "python"), "-c", "import labkit as lk; lk.ready()"])
    print(LOG.read_text(), end="")
    shutil.rmtree(str(CACHE), ignore_errors=True)
    LOG.unlink()


def program(folder, name):
    """The path of a program of an environment."""
    return folder / "Scripts" / (name + ".exe") if os.name == "nt" else folder / "bin" / name


def wait(words, size=None):
    """Run a command, which prints into install.log; say how much of `size` bytes it has fetched."""
    with LOG.open("w") as log:
        process = subprocess.Popen([str(x) for x in words], stdout=log, stderr=subprocess.STDOUT)
        try:
            while process.poll() is None:
                time.sleep(0.2 if size is None else 1.0)
                if size is not None:
                    there = sum(
                        x.lstat().st_size for x in CACHE.glob("archive-v0/**/*") if x.exists()
                    )
                    print(
                        "\r   {:2.0f} %".format(min(99.0, 100.0 * there / size)), end="", flush=True
                    )
        finally:
            process.kill()  # if this program is stopped
    if size is not None:
        print("\r   {:3.0f} %".format(100.0 if process.returncode == 0 else 0.0), flush=True)
    if process.returncode:
        raise Stop(why(LOG.read_text(errors="replace")))


def why(said):
    """The reason why a command failed, as a sentence."""
    if any(word in said for word in NO_NETWORK):
        return (
            "the network could not be reached. Check that a browser opens pypi.org (a network "
            "may ask you to sign in first), then type the same again; the downloads are kept"
        )
    if "No space left" in said or "os error 112" in said:
        return "the disk is full; make room, then type the same again"
    if "libgomp" in said:
        return "a library is missing. Type: sudo apt-get install libgomp1, then the same again"
    last = ([x for x in said.splitlines() if x.strip()] or ["it gave no reason"])[-1]
    return "a command failed: {}. All that it said is in {}".format(last.strip(" ."), LOG)


def tidy():
    """Delete files that only compilers need, other robots, and second copies of libraries."""
    for prefix in ENV.glob("lib/python*/site-packages/cmeel.prefix"):
        for folder in ("include", "lib/cmake", "share/doc"):
            shutil.rmtree(str(prefix / folder), ignore_errors=True)
        same = {}
        for path in sorted(prefix.glob("lib/**/*")):
            if path.suffix == ".a":
                path.unlink()
            elif path.is_file() and not path.is_symlink():
                first = same.setdefault(hashlib.sha256(path.read_bytes()).digest(), path)
                if first is not path and path.stat().st_size > 100000:
                    path.unlink()
                    os.link(str(first), str(path))
    for data in ENV.glob("lib/python*/site-packages/pybullet_data"):  # other robots
        shutil.rmtree(str(data))
    settings = ENV / "etc" / "jupyter" / "labconfig"
    settings.mkdir(parents=True, exist_ok=True)
    no_news = {"disabledExtensions": {"@jupyterlab/apputils-extension:announcements": True}}
    (settings / "page_config.json").write_text(json.dumps(no_news))


def wheel():
    """The path of the lab's wheel, which is beside this file."""
    found = sorted(HERE.glob("labkit-*.whl"))
    if not found:
        raise Stop("{} holds no labkit-*.whl; unpack the whole zip again".format(HERE))
    return str(found[-1])


def version():
    """A hash of what is to be installed and where, which changes with the instructor's zip."""
    known = hashlib.sha256(str(HERE).encode())
    for path in (wheel(), str(HERE / "constraints.txt")):
        known.update(Path(path).read_bytes())
    return known.hexdigest()


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except Stop as stop:
        sys.exit("Stopped: {}.".format(str(stop).rstrip(".")))
    except KeyboardInterrupt:
        sys.exit("Stopped. To go on, type the same again.")
    except OSError as error:
        sys.exit("Stopped: {}.".format(why("No space left") if error.errno == 28 else error))
