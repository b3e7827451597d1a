"""Flights of rays in a house: where and when they end."""

import numpy as np
import pytest
from handmade import shoebox

from home_mjx.audio_jax import BakeOptions
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.late_reverb.bake import stages
from home_mjx.audio_jax.late_reverb.bake.accumulate import fill_accumulator
from home_mjx.audio_jax.late_reverb.bake.bake import bake_house

METRES = AudioConfig.bin_seconds * AudioConfig().speed_of_sound  # of a time bin


def test_rays_grow_old_by_the_way_that_they_flew(monkeypatch):
    """In a small room, reflected every 1.3 m, too: ends by reflections cut those short that last.

    In the real SUNCG house rooms lost a third of their energy there.
    """
    found = {}

    def keep(tally, cells, *others):
        found["went"] = cells.gather(lambda gave: gave.portal_energy).sum(axis=(0, 1, 2, 3))
        return fill_accumulator(tally, cells, *others)

    monkeypatch.setattr(stages, "fill_accumulator", keep)
    bake_house(shoebox((2.0, 1.6, 2.4), absorption=0.02), BakeOptions(rays=40, max_bounces=60))
    went = found["went"]
    early = went[: int(stages.CELL_MIXING_LENGTH / METRES)].sum() / went.sum()
    assert went.sum() > 0
    assert early == pytest.approx(0, abs=0.15)
    assert np.flatnonzero(went)[-1] < 2 * stages.CELL_MIXING_LENGTH / METRES
