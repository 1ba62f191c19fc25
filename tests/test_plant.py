"""Plants are values; what each effect does to the arm is proven in test_plant_effects."""

import dataclasses

import numpy as np
import pytest
from numpy.testing import assert_array_equal

import labkit as lk
from labkit.plant import EVIDENCE

PER_JOINT = (
    "armature", "viscous", "stiction", "encoder_step",
    "velocity_noise",
)  # fmt: skip


def test_every_effect_is_off_by_default_and_on_the_ideal_arm():
    """All but name and command timeout are zero or False, and equal in both."""
    for field in dataclasses.fields(lk.Plant):
        if field.name in ("name", "fits", "command_timeout"):
            continue
        value = getattr(lk.IDEAL, field.name)
        assert not np.any(value), field.name
        assert getattr(lk.Plant(), field.name) == value


def test_every_number_of_baxter_has_evidence_and_lies_in_its_range():
    """A source, or the word that it is assumed; and the value is one of the plausible ones."""
    names = {field.name for field in dataclasses.fields(lk.Plant)} - {"name", "fits"}
    assert set(EVIDENCE) == names
    for name, evidence in EVIDENCE.items():
        value, least, most = (
            np.broadcast_to(np.asarray(x, dtype=float), 7)
            for x in (getattr(lk.BAXTER, name), evidence.least, evidence.most)
        )
        assert evidence.source
        if name != "encoder_offset":  # its ends have either sign
            assert (least <= value).all() and (value <= most).all(), name


def test_what_is_published_has_no_range_of_guesses():
    """Only viscous friction, which the URDF gives without saying of what, is tried at others."""
    for name, evidence in EVIDENCE.items():
        if not evidence.assumed and name != "viscous":
            assert evidence.least == evidence.most, name


def test_a_plant_is_a_value():
    """One number equals seven like it, equal plants have equal hashes, and none can be changed."""
    assert lk.Plant(stiction=1.0) == lk.Plant(stiction=[1.0] * 7)
    assert lk.Plant(stiction=np.float32(1.0)) == lk.Plant(stiction=1)
    assert hash(lk.Plant(stiction=1.0)) == hash(lk.Plant(stiction=np.ones(7)))
    assert lk.BAXTER != lk.IDEAL
    with pytest.raises(dataclasses.FrozenInstanceError):
        lk.BAXTER.payload = 1.0


def test_one_effect_is_changed_at_a_time():
    """dataclasses.replace changes the noise alone and leaves the stiction."""
    quiet = dataclasses.replace(lk.BAXTER, velocity_noise=0.0)
    assert_array_equal(quiet.each("velocity_noise", 7), np.zeros(7))
    assert quiet.stiction == lk.BAXTER.stiction
