"""Sound through the floor between two storeys, against what a diffuse field lets through."""

import numpy as np
import pytest
from storeys import Storey, metadata_of, stacked

from home_mjx.audio_jax.late_reverb.bake.bake import bake_house
from home_mjx.audio_jax.late_reverb.bake.options import BakeOptions
from home_mjx.datasets.outlines import RoomOutline
from home_mjx.scene_compile.materials.acoustic import transmission_loss_table
from home_mjx.scene_compile.pipeline.compile import compile_house


@pytest.mark.slow
def test_a_floor_lets_through_what_its_loss_says():
    """A quarter of a diffuse field's energy density and speed falls on each surface, and a share of it gets through.

    The upper room is smaller: only the part of the floor that both share counts.
    """
    below = Storey([RoomOutline("Living_Room", [(0, 0), (5, 0), (5, 4), (0, 4)])])
    above = Storey([RoomOutline("Bedroom", [(0, 0), (3, 0), (3, 4), (0, 4)])])
    house = stacked([below, above])
    compiled = compile_house(house, metadata_of(house))
    field = bake_house(compiled, BakeOptions(cell_size=2.0, rays=300, max_bounces=60))
    loss = transmission_loss_table()["wood_joist_floor"]
    wanted = 12 / 4 * 10 ** (-loss / 10)
    found = field.wall.astype(float)[0, 1]
    np.testing.assert_allclose(10 * np.log10(found / wanted), 0, atol=1.5)
    np.testing.assert_allclose(field.wall[0, 1], field.wall[1, 0])
    assert not np.any(field.opening[0, 1])
