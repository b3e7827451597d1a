"""The oracle of sound among triangles: against that of blocks, and its houses against the engine's."""

import acoustic_rooms as rooms
import decay_oracle
import jax.numpy as jnp
import numpy as np
import pytest
from numpy_measures import edt, t30

from home_mjx.bank.bank import HouseBank
from home_mjx.houses.house_set import HouseSet
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.scene import make_open_scene
from home_mjx.schema.compiled import RayKind

pytest.importorskip("embreex", reason="Embree is not installed")

import triangle_oracle

BIN = 0.004  # [s]
ROOMS = {"source's": slice(0, 3), "other": slice(3, 6)}


@pytest.fixture(scope="module")
def both() -> tuple[np.ndarray, np.ndarray]:
    """Coupled rooms as triangles and as blocks, energies (listeners, bands, bins)."""
    room = rooms.coupled()
    surfaces = triangle_oracle.surfaces_of(room.house, room.blocks.air)
    where = room.source, room.listeners, 0.8, BIN
    blocks = decay_oracle.fly(room.blocks, *where, particles=15_000, radius=0.4, seed=3).energy
    return triangle_oracle.fly(surfaces, *where, particles=15_000, radius=0.4), blocks


@pytest.mark.parametrize("name", ROOMS)
def test_triangles_sound_as_the_same_blocks_do(both, name):
    """Means over three listeners and seven octaves; their noise is a third of what is allowed."""
    ours, blocks = (energy[ROOMS[name]] for energy in both)
    level = 10 * np.log10(ours.sum(axis=2) / blocks.sum(axis=2))
    assert abs(level.mean()) < 0.15
    for read, most in ((t30, 0.03), (edt, 0.03)):
        mean = [np.mean([[read(band, BIN) for band in one] for one in energy]) for energy in (ours, blocks)]
        assert mean[0] == pytest.approx(mean[1], rel=most)


def test_balls_end_where_something_cuts_them():
    room = rooms.coupled()
    surfaces = triangle_oracle.surfaces_of(room.house, room.blocks.air)
    places = np.array([[1.0, 1.0, 1.6], [1.0, 1.8, 1.6], [1.0, 1.95, 1.6]])  # the wall is at y = 2
    np.testing.assert_allclose(triangle_oracle.free_radii(surfaces, places), [0.35, 0.2, 0.0], atol=2e-3)


def test_rays_meet_what_the_engine_has_with_all_doors_open(rng):
    """The oracle places triangles and opens doors itself: 99.9 % of distances agree within a millimetre."""
    house = HouseSet("procedural:1?seed=5&preset=flat").load()[0]
    assert len(house.doors.instance)
    scene = make_open_scene(HouseBank.from_compiled([house]), 0)
    start = np.float32(house.navigation.start[rng.integers(len(house.navigation.start), size=20_000)] + [0, 0, 1.3])
    way = rng.normal(size=start.shape)
    way = np.float32(way / np.linalg.norm(way, axis=1, keepdims=True))
    hit = cast(scene, jnp.asarray(start), jnp.asarray(way), mask=int(RayKind.SOUND))
    found = triangle_oracle.surfaces_of(house, np.zeros(7)).rays().run(start, way, output=1)
    ours = np.where(found["geomID"] >= 0, found["tfar"], np.inf)
    assert np.isclose(ours, hit.t, atol=1e-3).mean() > 0.999
