"""The exemplars of notebook 08: their numbers are those of the runs that they show."""

import re
from pathlib import Path

import jupytext
import numpy as np
import pytest

from labkit.course import PUBLIC_ARMS
from labkit.course.authoring.layout import Course

COURSE = Course.here(Path(__file__))


@pytest.mark.soak
def test_the_numbers_of_the_exemplars_are_measured(monkeypatch):
    """Both reports' results, the prediction with its band, and what the longer run says."""
    monkeypatch.setenv("MPLBACKEND", "Agg")
    cells = jupytext.read(COURSE.notebook_source("08_report"), fmt="py:percent").cells
    text = " ".join("\n".join(c.source for c in cells if c.cell_type == "markdown").split())
    code = "\n".join(c.source for c in cells if "height_after" in c.source)
    found = {}
    exec("import labkit as lk, numpy as np\n" + code, found)
    above, below, model = found["above"], found["below"], found["model"]

    first = above[0][1]
    (mean, spread) = re.search(r"end was ([\d.]+) ± ([\d.]+) mm", text).groups()
    assert abs(float(mean) - first[-1]) < 1e-3
    assert float(spread) == round(first[-100:].std(), 3)

    middle = np.array([(a[1][-1] + b[1][-1]) / 2 for a, b in zip(above, below, strict=True)])
    half = 4.303 * middle.std(ddof=1) / np.sqrt(3)
    assert f"rests at {middle.mean():.1f} ± {half:.1f} mm (95 %" in text
    ends = [np.mean([z[-1] for _, z in runs]) for runs in (above, below)]
    assert f"rested at {ends[0]:.1f} mm, as" in text
    assert f"below rested at {ends[1]:.1f} mm" in text
    assert f"up to {(ends[0] - ends[1]) / 2:.1f} mm" in text

    J, ready = found["J"], found["ready"]
    sag_of_1_kg = (J @ np.linalg.solve(model.mass_matrix(ready), J[2] * 9.81))[2] / 40.0 * 1e3
    load, around = map(float, re.search(r"carries ([\d.]+) ± ([\d.]+) kg", text).groups())
    assert abs(PUBLIC_ARMS[0].payload - load) < around
    assert f"{load * sag_of_1_kg:.1f} ± {around * sag_of_1_kg:.1f} mm" in text
    # The difference of the two numbers as they are printed: a reader subtracts those.
    missing = round(load * sag_of_1_kg, 1) + round(middle.mean(), 1)
    assert f"the {missing:.1f} mm that are missing" in text
    assert f"{-middle.mean() / sag_of_1_kg:.2f} kg would explain" in text
