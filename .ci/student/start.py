"""Start the lab: `python3 start.py` installs what the notebooks need, once, and opens them.

It needs Python 3.11, 3.12 or 3.13 and nothing else.  It installs everything into the folder
``.venv`` beside it; delete that folder to start from the beginning.  `python3 start.py install`
installs and does not open the notebooks.
"""

# Any Python 3 must be able to read this file, so that an old one can be told that it is too old.
import hashlib
import json
import os
import platform
import shutil
import subprocess
import sys
import threading
from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path

HERE = Path(__file__).resolve().parent
ENV = HERE / ".venv"
DONE = ENV / "made_for.txt"
CACHE = HERE / ".fetched"
LOG = HERE / "install.log"
VERSIONS = ("3.13", "3.12", "3.11")
PLACES = ("/opt/homebrew/bin", "/usr/local/bin", "/usr/bin", "~/.local/bin")
BY_CONDA = (
    "install Miniforge, and type in this folder, one after the other: conda env create -f "
    "environment.yml; conda activate baxter-lab; python start.py"
)
SYSTEMS = (("linux", "x86_64"), ("linux", "aarch64"), ("darwin", "arm64"))
FREE = 1.6e9
NO_NETWORK = (
    "NewConnectionError", "Name or service not known", "nodename nor servname", "NameResolution",
    "Temporary failure in name resolution", "Network is unreachable", "ProxyError", "timed out",
    "Connection refused", "Failed to establish",
)  # fmt: skip
NEEDED = ("numpy", "scipy", "mujoco", "pinocchio", "cv2", "matplotlib", "jupyterlab", "anywidget")


class Stop(Exception):
    """The reason why this program cannot continue, as a sentence."""


def main(words):
    """Make the environment if there is none, and open the notebooks."""
    if words not in ([], ["install"]):
        raise Stop("type start.py alone to open the notebooks, or start.py install to prepare them")
    if in_conda():
        python = Path(sys.executable)
        if not made():
            run(python, "-m", "pip", "install", "--no-deps", "--force-reinstall", wheel())
            note_that_it_is_made()
    else:
        python = ENV / "bin" / "python"
        if not made():
            other = right_python()
            if other:
                return become([other, HERE / "start.py"] + words)
            make(python)
    if words == ["install"]:
        return 0
    os.environ["PATH"] = str(python.parent) + os.pathsep + os.environ.get("PATH", "")
    keep_to_this_folder()
    words = ["--log-level=ERROR", "--notebook-dir=" + str(HERE / "assignments")]
    words += ["--KernelManager.transport_encryption=auto"]  # else each kernel prints a warning
    words += ["--LabApp.default_url=/lab/tree/START_HERE.ipynb"]
    words += ["--ServerApp.answer_yes=True"]  # Ctrl-C ends it without a question
    words += ["--allow-root"] if is_root() else []
    print("opening JupyterLab at START_HERE, which takes about ten seconds;", end=" ")
    print("to end it, press Ctrl-C here", flush=True)
    return become([python, "-m", "jupyterlab"] + words)


def keep_to_this_folder():
    """Do not reopen notebooks of other courses; replace a home folder that cannot be written."""
    room = Path(sys.prefix) if in_conda() else ENV
    os.environ["JUPYTERLAB_WORKSPACES_DIR"] = str(room / "workspaces")
    if not os.access(os.path.expanduser("~"), os.W_OK):
        os.environ["HOME"] = str(room / "home")
        Path(os.environ["HOME"]).mkdir(exist_ok=True)


def in_conda():
    """Whether this is a conda environment that has the packages for which pip has no wheels."""
    return (Path(sys.prefix) / "conda-meta").is_dir() and all(map(find_spec, NEEDED))


def right_python():
    """None if this Python is suitable, otherwise the path of one that is."""
    if (sys.platform, platform.machine()) not in SYSTEMS:
        raise Stop(
            "on {} ({}) pip does not have everything that the lab needs, but conda does: {}".format(
                platform.system(), platform.machine(), BY_CONDA
            )
        )
    if "{}.{}".format(*sys.version_info) in VERSIONS:
        return None
    for version in VERSIONS:
        for folder in os.environ.get("PATH", "").split(os.pathsep) + list(PLACES):
            python = Path(folder).expanduser() / ("python" + version)
            if python.is_file() and works(python):
                return str(python)
    raise Stop(
        "this is Python {}, and the lab needs 3.11, 3.12 or 3.13. {}, then type the same again. "
        "If you cannot, {}".format(platform.python_version(), how_to_get_python(), BY_CONDA)
    )


def works(python):
    """Whether a Python runs; pyenv puts programs on the path that only print an error."""
    words = [str(python), "-c", "import ssl, venv"]
    return subprocess.call(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL) == 0


def how_to_get_python():
    """How to get a Python on this system, as a sentence."""
    if sys.platform == "darwin":
        return "Get 3.13 from python.org (the macOS installer), or type: brew install python@3.13"
    if shutil.which("apt-get"):
        return "Type: sudo apt-get install python3.11-venv (or python3.12-venv, python3.13-venv)"
    return "Get one from your system's packages, or type: uv python install 3.13"


def make(python):
    """Make the environment from the beginning; only downloads are kept of an unfinished one."""
    free = shutil.disk_usage(str(HERE)).free
    if free < FREE:
        raise Stop(
            "this disk has {:.1f} GB free, and the lab needs {:.1f} GB while it is installed; "
            "make room, then type the same again".format(free / 1e9, FREE / 1e9)
        )
    if ENV.exists():
        print("the environment is incomplete or of another version, so it is made again")
        shutil.rmtree(str(ENV))
    print("1 of 3: making an environment in {}".format(ENV), flush=True)
    try:
        import venv

        venv.create(str(ENV), with_pip=True)
    except (ImportError, subprocess.CalledProcessError):
        shutil.rmtree(str(ENV), ignore_errors=True)
        raise Stop(
            "this Python cannot make environments. Type: sudo apt-get install python{}.{}-venv "
            "(or what your system calls it), then the same again".format(*sys.version_info)
        )
    print("2 of 3: fetching about 300 MB", flush=True)
    install(python)
    print("3 of 3: moving the arm for the first time, which takes a while", flush=True)
    tidy(python)
    run(python, "-c", "import labkit as lk; lk.ready()")
    shutil.rmtree(str(CACHE), ignore_errors=True)
    LOG.unlink()
    note_that_it_is_made()


def install(python):
    """Let pip install the lab, and print what it fetches and how far it is."""
    words = ["install", "--no-compile", "--progress-bar", "off", "--disable-pip-version-check"]
    words += ["--cache-dir", str(CACHE), "--retries", "2", "--timeout", "20"]
    words += ["--constraint", str(HERE / "constraints.txt"), wheel() + "[notebook]"]
    command = [str(python), "-m", "pip"] + words
    said, count, warned, end = [], 0, False, threading.Event()
    with LOG.open("w") as log, subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True
    ) as pip, ended_too(pip):  # fmt: skip
        for line in pip.stdout:
            log.write(line)
            said.append(line)
            if line.startswith("Collecting "):
                count += 1
                if count % 20 == 0:
                    print("   {} packages found".format(count), flush=True)
            elif line.lstrip().startswith(("Downloading ", "Using cached ")) and ".whl (" in line:
                name, version = line.split()[-3].split("/")[-1].split("-")[:2]
                print("   {} {} {}".format(name, version, " ".join(line.split()[-2:])), flush=True)
            elif "Retrying" in line and not warned:
                warned = True
                print("   the network does not answer; trying again", flush=True)
            elif line.startswith("Installing collected packages"):
                total = line.count(",") + 1
                threading.Thread(target=count_installed, args=(total, end), daemon=True).start()
    end.set()
    if pip.returncode:
        raise Stop(why("".join(said)))


@contextmanager
def ended_too(pip):
    """Stop pip too if this program is stopped."""
    try:
        yield
    except BaseException:
        pip.kill()
        raise


def count_installed(total, end):
    """Print how many packages are in the environment, until `end` is set."""
    before, quiet = -1, 0
    while not end.wait(2.0):
        found = sum(1 for _ in ENV.glob("lib/python*/site-packages/*.dist-info")) - 1  # pip itself
        quiet = 0 if found != before else quiet + 1
        if quiet == 0:
            print("   {} of {} in place".format(min(found, total), total), flush=True)
        elif quiet % 15 == 0:
            print("   still at work", flush=True)
        before = found


def why(said):
    """The reason why pip stopped, as a sentence."""
    if any(word in said for word in NO_NETWORK):
        return (
            "the network could not be reached. Check that a browser opens pypi.org (a network "
            "may ask you to sign in first), then type the same again; the downloads are kept"
        )
    if "No space left" in said or "Errno 28" in said:
        return "the disk is full; make room, then type the same again"
    errors = [x for x in said.splitlines() if x.startswith("ERROR:")] or ["it gave no reason"]
    return "pip stopped: {}. Its whole output is in {}".format(errors[0][6:].strip(" ."), LOG)


def tidy(python):
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


def become(words):
    """Continue as another program; on systems where that is impossible, run it and wait."""
    words = [str(word) for word in words]
    if os.name == "posix":
        os.execv(words[0], words)
    return subprocess.call(words)


def run(*words):
    """Run a command; raise `Stop` with its output if it fails."""
    done = subprocess.run(
        [str(word) for word in words],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True,
    )  # fmt: skip
    if done.returncode == 0:
        print(done.stdout, end="")
    elif "libgomp" in done.stdout:
        raise Stop("a library is missing. Type: sudo apt-get install libgomp1, then the same again")
    else:
        raise Stop("the lab is installed but does not run:\n" + done.stdout.strip())


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


def made():
    """Whether everything has been installed already."""
    return place().is_file() and place().read_text() == version()


def place():
    """The file that notes which version has been installed."""
    return Path(sys.prefix) / DONE.name if in_conda() else DONE


def note_that_it_is_made():
    """Note that everything is installed; without the note, the next start installs it again."""
    place().write_text(version())


def is_root():
    """Whether the user is root, which Jupyter allows only with an option."""
    return hasattr(os, "geteuid") and os.geteuid() == 0


def build_wheel(to, config_settings=None, metadata_directory=None):
    """Supply the finished wheel when pip installs this folder or its zip."""
    return shutil.copy(wheel(), to) and os.path.basename(wheel())


if __name__ == "__main__":
    try:
        sys.exit(main(sys.argv[1:]))
    except Stop as stop:
        sys.exit("Stopped: {}.".format(str(stop).rstrip(".")))
    except KeyboardInterrupt:
        sys.exit("Stopped. To go on, type the same again.")
    except OSError as error:
        full = error.errno == 28
        sys.exit("Stopped: {}.".format(why("No space left") if full else error))
