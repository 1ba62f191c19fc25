"""The first process in a sandbox: it loads what notebooks import and forks for each session.

The forkserver does not run students' code.  Parsers are forked from its twin, which has loaded very
little, so that a fork takes two thirds of the time.  Each child becomes the first process of its
own process namespace and gives up everything (see `confine`) before it reads what a student wrote.
"""

from __future__ import annotations

import gc
import json
import os
import shutil
import socket
import sys
import traceback
from collections.abc import Callable, Sequence
from contextlib import suppress
from importlib import import_module
from typing import Any

from . import confine, parse
from .isolation import Bare, ByUser, Namespaces
from .protocol import Connection, Disconnected

MAGIC = "IPython.core.inputtransformer2"
"""The module that translates the ``%`` and ``!`` lines of a notebook."""
LOADED = ("numpy", "scipy.linalg", "matplotlib.pyplot", MAGIC)
"""Modules that most answers need; each of them makes every fork slower, so there are no more.

The rest of scipy would cost every submission 6 % of its processor time, used or not.
"""

Serve = Callable[[Connection, dict[str, Any]], None]
"""What a child runs, given its connection and the request for which it was forked."""


def main() -> None:
    """Serve the worker until it closes its sockets: stdin is for students, stdout for parsers.

    Modules named on the command line are loaded, too.  ``--bare`` turns confinement off, for
    ``labkit grade --unsafe-no-isolation``; ``--by-user`` confines only by user id, see
    `isolation.ByUser`.
    """
    kinds: dict[str, type[Bare]] = {"--bare": Bare, "--by-user": ByUser}
    kind = next((kinds[word] for word in sys.argv if word in kinds), Namespaces)
    modules = [word for word in sys.argv[1:] if word not in kinds]
    students, parsers = (socket.socket(fileno=os.dup(number)) for number in (0, 1))
    confinement = kind()
    nowhere = os.open(os.devnull, os.O_RDWR)
    os.dup2(nowhere, 0)
    os.dup2(nowhere, 1)
    if os.fork():
        control, other = students, parsers
        serve = _load(modules)
    else:
        control, other = parsers, students
        import_module(MAGIC)
        serve = _parse
    other.close()
    space = confine.address_space()
    gc.collect()
    gc.freeze()
    worker = Connection(control)
    worker.send({"ready": True})
    while True:
        try:
            request, ends = _read(control)
        except Disconnected:
            confinement.close()
            return
        if "kill" in request:
            confinement.kill(request["kill"], whole=request["whole"])
            worker.send({"killed": request["kill"]})
            continue
        child = confinement.fork()
        if child:
            os.close(ends[0])
            worker.send({"pid": child})
            continue
        os.dup2(nowhere, 2)
        control.close()
        connection = Connection(socket.socket(fileno=ends[0]))
        try:
            confinement.enter(request["limits"] | {"address_space": space}, request["uid"])
            connection.send({"confined": True})
            serve(connection, request)
        except BaseException:
            with suppress(BaseException):
                connection.send({"failed": traceback.format_exc(limit=3)[-2000:]})
        os._exit(0)


def _load(modules: Sequence[str]) -> Serve:
    """Import what notebooks use and install the stubs; return the function that runs a notebook."""
    with suppress(FileNotFoundError, KeyError):
        shutil.copytree("/lab/mpl", os.environ["MPLCONFIGDIR"])  # listing the fonts takes long
    for name in (*LOADED, *modules):
        import_module(name)
    import labkit

    from . import runner, stubs

    with labkit.Arm("left") as arm:  # the physics engine and the model load what they need
        arm.model.mass_matrix(arm.state().q)
    stubs.install()
    return runner.serve


def _parse(connection: Connection, request: dict[str, Any]) -> None:
    """Read a notebook, of which ``size`` bytes follow, and send its cells."""
    data = bytearray()
    connection.socket.settimeout(request["limits"]["parse"])
    while len(data) < request["size"]:
        piece = connection.socket.recv(min(1 << 20, request["size"] - len(data)))
        if not piece:
            raise Disconnected("the file did not arrive")
        data += piece
    connection.send(parse.read(bytes(data)))


def _read(control: socket.socket) -> tuple[dict[str, Any], list[int]]:
    """Receive a request, and the socket that comes with it, if any."""
    control.settimeout(None)
    data, ends, _, _ = socket.recv_fds(control, 65536, 1)
    if not data:
        raise Disconnected("the worker is gone")
    request: dict[str, Any] = json.loads(data)
    return request, ends


if __name__ == "__main__":
    main()
