"""Flights of rays in a house: where and when they end."""

import numpy as np
import pytest
from handmade import shoebox

from home_mjx.audio_jax import BakeOptions
from home_mjx.audio_jax.baking import bake
from home_mjx.audio_jax.base.config import AudioConfig

METRES = AudioConfig.bin_seconds * AudioConfig().speed_of_sound  # of a time bin


def test_rays_grow_old_by_the_way_that_they_flew(monkeypatch):
    """In a small room, reflected every 1.3 m, too: ends by reflections cut those short that last.

    In the real SUNCG house rooms lost a third of their energy there.
    """
    found = {}

    def keep(baker, cells, gates, given, passed):
        found["went"] = cells.went.sum(axis=(0, 1, 2, 3))
        return join(baker, cells, gates, given, passed)

    join = bake._Baker._join
    monkeypatch.setattr(bake._Baker, "_join", keep)
    bake.bake_house(shoebox((2.0, 1.6, 2.4), absorption=0.02), BakeOptions(rays=40, bounces=60))
    went = found["went"]
    early = went[: int(bake.YOUNG / METRES)].sum() / went.sum()
    assert went.sum() > 0
    assert early == pytest.approx(0, abs=0.15)
    assert np.flatnonzero(went)[-1] < 2 * bake.YOUNG / METRES
