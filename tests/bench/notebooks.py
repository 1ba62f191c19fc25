"""The time and memory that solved notebooks need on a student's machine or on a hub."""

import tempfile

import nbformat

from labkit.grader.release import release

from .grading import fresh_course

USED = """
import resource, time
print(time.process_time(), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024)
"""


def worked_through(path):
    """Processor time [s] and peak memory [MB] of a kernel that runs a notebook."""
    from nbclient import NotebookClient
    from traitlets.config import Config

    notebook = nbformat.read(path, as_version=4)
    notebook.cells.append(nbformat.v4.new_code_cell(USED))
    place = {"metadata": {"path": str(path.parent)}}
    with tempfile.TemporaryDirectory() as sockets:
        talk = Config({"KernelManager": {"transport": "ipc", "ip": f"{sockets}/kernel"}})
        NotebookClient(
            notebook, timeout=240, kernel_name="python3", resources=place, config=talk
        ).execute()
    return tuple(map(float, notebook.cells[-1].outputs[-1].text.split()))


def measure():
    """The largest numbers of seconds and megabytes that the kernel of a solved notebook needs."""
    found = {}
    with fresh_course() as course:
        for name in course.names():
            release(course, name, seed=1)
            found[name] = worked_through(course.solution / name / f"{name}.ipynb")
    return {
        "notebook_s": max(seconds for seconds, _ in found.values()),
        "notebook_mb": max(megabytes for _, megabytes in found.values()),
    }
