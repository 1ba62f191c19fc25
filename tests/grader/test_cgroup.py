"""Groups of processes that the kernel counts together."""

from __future__ import annotations

import os
import signal
import subprocess

from labkit.grader.sandbox.cgroup import SANDBOX, Group


def test_nothing_in_a_group_outlives_it():
    """A process that is left in a group, as by a killed bubblewrap, ends with the group."""
    group = Group.make(f"{os.getpid()}-outlived", SANDBOX)
    folders = group.folders if group else ()
    with subprocess.Popen(["sleep", "600"], preexec_fn=group.enter if group else None) as left:
        try:
            if group:
                group.remove()
                assert left.wait(60.0) == -signal.SIGKILL
        finally:
            left.kill()
    assert not any(folder.exists() for folder in folders)
