"""Maps of the error over the gains."""

import numpy as np
import pytest

from labkit import recordings
from solutions.study import maps as makers


@pytest.mark.parametrize("name", recordings.names("maps"))
def test_a_shipped_map_is_what_its_command_measures(name):
    """One pair of gains, run again with the same seeds."""
    found = recordings.error_map(name)
    (title,) = found.cases
    controller, plant = title.split(" on the ")[0], title.split()[-3]
    i, j = 4, 1
    again = [makers.rms(controller, plant, found.Kp[i], found.Kd[j], s)["rms_mm"] for s in (0, 1)]
    assert np.mean(again) == pytest.approx(found.array()[i, j], rel=1e-3)
