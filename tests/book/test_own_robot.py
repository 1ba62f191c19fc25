"""The page on one's own arm: its code works as it stands, in the order in which it stands."""

import re
import shutil

import pytest
from arms import FILES
from book_pages import ROOT

import labkit as lk

BLOCKS = re.findall(r"```python\n(.*?)```", (ROOT / "book/own_robot.md").read_text(), re.DOTALL)


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """What its code leaves behind: the names, and the folder."""
    folder = tmp_path_factory.mktemp("own")
    shutil.copy(FILES["ur5"], folder)
    names = {}
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for block in BLOCKS:
            exec(compile(block, "own_robot.md", "exec"), names)
    return names, folder


def test_a_ur5_draws_the_circle_and_its_log_is_kept(ran):
    """With six joints it is off by 10 mm at most, and by more than 2 mm RMS, as the page says."""
    names, folder = ran
    log = lk.Log.load(folder / "circle.npz")
    assert log.robot.n == 6
    for each in (log, names["log"]):
        assert lk.metrics.summary(each).max_mm < 10.0
    assert 2.0 < lk.metrics.summary(log).rms_mm < 10.0, "the page says: some millimetres"
