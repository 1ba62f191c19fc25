"""A worker: a process of its own that grades one submission after another in its own sandbox.

It reads jobs and writes results as lines of JSON, so it may live on any machine.
"""

from __future__ import annotations

import json
import os
import sys
from functools import lru_cache
from pathlib import Path
from typing import Any

from .checker import grade, rejection
from .limits import Limits, slowness
from .plan import imports
from .results import Bundle, Result
from .sandbox import Broken, NoIsolation, Sandbox
from .submission import Submission

TRIES = 2


class Desk:
    """What a worker keeps from one job to the next: its sandbox."""

    def __init__(self, *, isolated: bool) -> None:
        self.isolated = isolated
        self.sandbox: Sandbox | None = None

    def do(self, job: dict[str, Any]) -> Result:
        """Grade one submission; whatever it breaks is made again.

        Raises:
            NoIsolation: There is no sandbox on this machine.
        """
        bundle = _bundle(job["bundle"], job["hash"])
        submission = Submission(job["student"], job["assignment"], Path(job["folder"]))
        limits = Limits(**job["limits"]).scaled(slowness())
        data, note, why = submission.read(limits.notebook)
        for _ in range(TRIES):
            if self.sandbox is None:
                loads = imports(bundle.data["cells"])
                self.sandbox = Sandbox(loads, isolated=self.isolated)
            if why:
                return rejection(why, submission.student, bundle, self.sandbox.level)
            try:
                return grade(data, submission.student, bundle, self.sandbox, limits, note)
            except Broken:
                self.close()
        level = "bubblewrap" if self.isolated else "none"
        says = f"its code broke the sandbox {TRIES} times; look at it yourself"
        return rejection(says, submission.student, bundle, level, data)

    def close(self) -> None:
        """End the sandbox."""
        sandbox, self.sandbox = self.sandbox, None
        if sandbox is not None:
            sandbox.close()


@lru_cache(maxsize=4)
def _bundle(path: str, key: str) -> Bundle:
    bundle = Bundle(json.loads(Path(path).read_text(encoding="utf-8")))
    if bundle.data["hash"] != key:
        raise ValueError(f"{path} was released again while it was graded")
    return bundle


def main(*, isolated: bool) -> int:
    """Serve until stdin ends."""
    out = os.fdopen(os.dup(1), "w", encoding="ascii")
    os.dup2(2, 1)
    desk = Desk(isolated=isolated)
    try:
        for line in sys.stdin:
            try:
                answer = {"result": desk.do(json.loads(line)).text()}
            except NoIsolation as error:
                answer = {"no isolation": str(error)}
            except Exception as error:
                answer = {"failed": f"{type(error).__name__}: {error}"}
            print(json.dumps(answer), file=out, flush=True)
    finally:
        desk.close()
    return 0


if __name__ == "__main__":
    sys.exit(main(isolated="--no-isolation" not in sys.argv))
