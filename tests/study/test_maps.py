"""Maps of the error over the gains."""

import numpy as np
import pytest

import labkit as lk
from labkit.study import maps
from solutions import maps as makers


@pytest.mark.parametrize("name", maps.names())
def test_a_shipped_map_is_what_its_command_measures(name):
    """One pair of gains, run again with the same seeds."""
    found = maps.error_map(name)
    controller, plant = found.title.split(" on the ")[0], found.title.split()[-3]
    i, j = 4, 1
    again = [makers.rms(controller, plant, found.Kp[i], found.Kd[j], s)["rms_mm"] for s in (0, 1)]
    assert np.mean(again) == pytest.approx(found.rms_mm[i][j], rel=1e-3)


def test_the_map_names_its_best_gains_and_says_itself_in_words():
    found = maps.ErrorMap("a test", (1.0, 2.0), (0.0, 0.1), ((3.0, 2.0), (1.0, None)), ("", ""), "")
    assert found.best == (2.0, 0.0, 1.0)
    assert "least 1 mm at Kp = 2, Kd = 0" in found.describe()
    assert "1 of 4 pairs lost the arm" in found.describe()


def test_an_unknown_map_is_a_sentence():
    with pytest.raises(lk.errors.UnknownName, match="no error map 'x'; there is"):
        maps.error_map("x")
