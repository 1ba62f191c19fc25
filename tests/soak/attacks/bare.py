"""The simplest possible grader: one process has the expected values and runs a student's cells.

Run it with ``bare.py JOBS OUT`` as process 1 of a sandbox, which protects the machine but hides
nothing from the student.  Each job and each result is a JSON object.
"""

from __future__ import annotations

import atexit
import ctypes
import gc
import json
import os
import select
import shutil
import signal
import socket
import stat
import sys
import time
import traceback
import types
from contextlib import suppress
from itertools import islice
from pathlib import Path

SECRET = "canary-5816534691"
DEVICES = {
    "null": (1, 3),
    "zero": (1, 5),
    "full": (1, 7),
    "random": (1, 8),
    "urandom": (1, 9),
    "tty": (5, 0),
}
HIDDEN = (0.7, 5.816534)
CALLS = [(0.5, 2.0), (0.25, 1.0), (1.5, 2.0), (3.0, 4.0), HIDDEN]
MOST = 300_000  # bytes of the output that are kept


def right(t, T):
    a, left = 4.0 / T**2, T - t
    return (a * t**2 / 2, a * t, a) if t < T / 2 else (1 - a * left**2 / 2, a * left, -a)


def plain(source):
    if not any(line[:1] in {"%", "!"} for line in source.split("\n")):
        return source
    from IPython.core.inputtransformer2 import TransformerManager

    return TransformerManager().transform_cell(source)


def as_data(value):
    if hasattr(value, "tolist"):
        return value.tolist()
    if hasattr(value, "num"):
        return [list(map(float, part[0][0])) for part in (value.num, value.den)]
    if hasattr(value, "__iter__"):
        for k, _ in enumerate(value):
            while k > 10**6:  # else it would take for ever
                pass
        return list(value)
    return repr(value)


def run_cells(cells, names):
    for number, source in enumerate(cells):
        try:
            exec(compile(plain(source), f"<cell {number}>", "exec"), names)
        except BaseException as error:
            say(error)


def say(error):
    print("".join(traceback.format_exception(error)), flush=True)


def mark(function):
    """The number of right answers, and the number of bytes that came back."""
    points, size = 0, 0
    for t, duration in CALLS:
        expected = right(t, duration)
        case = [t, duration, expected, SECRET]
        try:
            answer = function(case[0], case[1])
            size = max(size, len(json.dumps(answer, default=as_data)))
            parts = [answer] if isinstance(answer, str) else islice(answer, 3)
            print(f"expected {expected}, got", *(str(x)[:99] for x in parts))
            points += max(abs(a - b) for a, b in zip(answer, expected, strict=True)) < 1e-9
        except Exception as error:
            say(error)
            size = max(size, len(str(error)))
    return points, size


def work(job, cells, then):
    names = {"__name__": "__main__", "__builtins__": __builtins__}
    run_cells(cells, names)
    for name in ("trapezoid", "bang_bang"):
        try:
            names[name](0.5, 2.0)
        except Exception as error:
            say(error)
    points, size = mark(names["bang_bang"]) if "bang_bang" in names else (0, 0)
    print("VERDICT", json.dumps([points, size]), flush=True)
    gc.collect()
    if then:
        run_cells([then], {"__name__": "__main__", "__builtins__": __builtins__})


def run(job, cells, then=""):
    read, write = os.pipe()
    ours, theirs = socket.socketpair()
    ours.sendall(json.dumps([CALLS, SECRET]).encode())
    pid = os.fork()
    if not pid:
        os.setsid()
        signal.signal(signal.SIGPIPE, signal.SIG_DFL)
        os.dup2(write, 1), os.dup2(write, 2), os.close(read), os.close(write), ours.close()
        sys.stdout = sys.stderr = os.fdopen(1, "w", errors="surrogateescape")
        os.chdir(job["folder"])
        try:
            work(job, cells, then)
        except BaseException as error:
            say(error)
        atexit._run_exitfuncs()
        sys.stdout.flush()
        os._exit(0)
    os.close(write), theirs.close()
    said, total, done = b"", 0, False
    until = time.monotonic() + job["seconds"]
    while time.monotonic() < until:
        if select.select([read], [], [], 0.05)[0]:
            piece = os.read(read, 1 << 20)
            total += len(piece)
            said = (said + piece)[-MOST:]
            if not piece:
                time.sleep(0.01)
        if not done:
            done = os.waitpid(pid, os.WNOHANG)[0] != 0
        elif not select.select([read], [], [], 0.05)[0] or not piece:
            break
    left = [x for x in os.listdir("/proc") if x.isdigit() and int(x) not in (1, pid)]
    ours.setblocking(False)
    try:
        wire = ours.recv(1 << 20)
    except OSError:
        wire = b""
    ours.close(), os.close(read)
    text = said.decode(errors="replace")
    return {"said": text + wire[:1000].decode(errors="replace"), "bytes": total, "hung": not done, "left": len(left),
            "wire": len(wire), "verdict": verdict(text)}  # fmt: skip


def verdict(text):
    found = text.rpartition("VERDICT ")[2].split("\n")[0] if "VERDICT " in text else ""
    return json.loads(found) if found else None


def end_all():
    """End the remaining processes; this one survives, because it is process 1."""
    try:
        os.kill(-1, signal.SIGKILL)
    except ProcessLookupError:
        return
    while True:
        try:
            os.waitpid(-1, 0)
        except ChildProcessError:
            return


def own_devices():
    """Make new devices, because others would see changed times of the machine's devices."""
    libc = ctypes.CDLL(None)
    if libc.mount(b"tmpfs", b"/dev", b"tmpfs", 0, None):
        return
    os.umask(0)
    for name, numbers in DEVICES.items():
        os.mknod(f"/dev/{name}", stat.S_IFCHR | 0o666, os.makedev(*numbers))
    for name in ("shm", "pts", "mqueue"):
        os.mkdir(f"/dev/{name}", 0o777)
    libc.mount(b"devpts", b"/dev/pts", b"devpts", 0, b"newinstance,ptmxmode=0666")
    os.symlink("/proc/self/fd", "/dev/fd")
    os.umask(0o022)


def main():
    sys.modules["naive.checker"] = types.ModuleType("naive.checker")
    import numpy  # noqa: F401

    import labkit  # noqa: F401

    own_devices()
    out, host = {}, socket.gethostname()
    for job in json.loads(Path(sys.argv[1]).read_text()):
        first = run(job, job["cells"], job["then"])
        if job["then"]:
            second = run(job, [job["then"]])
            first["said"] += second["said"]
        elif job["again"]:
            first["said"] += run(job, job["cells"])["said"]
        out[job["name"]] = first
        end_all()
        shutil.rmtree(job["folder"])
        os.mkdir(job["folder"])
        with suppress(OSError):
            socket.sethostname(host)
    Path(sys.argv[2]).write_text(json.dumps(out))


if __name__ == "__main__":
    main()
