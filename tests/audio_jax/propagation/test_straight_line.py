"""The straight line through whatever stands on it is what it was when each of its casts was made by itself."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scenes import HEAD

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, SoundSource
from home_mjx.audio_jax.base.options import EarlyPaths, Omni
from home_mjx.audio_jax.propagation.paths import MIN_PATH_LENGTH, RAY_OFFSET, StraightLine, trace_straight_line
from home_mjx.audio_jax.propagation.surfaces import surface_at
from home_mjx.houses import load_bank
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.schema.compiled import BANDS, RayKind

PAIRS = 150  # of points, in each house and state of its doors
NOBODY = jnp.zeros((0, 3)), jnp.zeros((0, 4))


def cast_by_cast(scene, source, listener, config):
    """A cast for each surface, which counts unless one of the same barrier has."""
    exclude, emitter = jnp.int32(listener.body), jnp.int32(source.body)
    offset = source.pos - listener.pos
    distance = jnp.maximum(jnp.linalg.norm(offset), MIN_PATH_LENGTH)
    direction = (offset / distance)[None]

    def step(carry, index):
        start, skipped, seen, energy, met_any, _ = carry
        ray = scene, listener.pos[None], direction
        hit = cast(*ray, t_min=start, t_max=distance - RAY_OFFSET, exclude=skipped, mask=int(RayKind.SOUND))
        met = surface_at(scene, direction, hit)
        barrier, object_id, blocked = met.barrier[0], met.object_id[0], hit.instance[0] >= 0
        own = (object_id >= 0) & ((object_id == exclude) | (object_id == emitter))
        counts = blocked & ~own & ~((barrier >= 0) & jnp.any(seen == barrier))
        kinds = counts & jnp.stack([object_id < 0, object_id >= 0])
        energy = jnp.where(kinds[:, None], energy * met.transmission, energy)
        seen = seen.at[index].set(jnp.where(blocked, barrier, -1))
        start = jnp.where(blocked, hit.t[0] + RAY_OFFSET, distance)
        skipped = jnp.where(blocked & (object_id >= 0), object_id, skipped)
        return (start, skipped, seen, energy, met_any | kinds, blocked), None

    seen = jnp.full(config.early.max_crossings, -1, jnp.int32)
    start = jnp.float32(0), exclude, seen, jnp.ones((2, len(BANDS))), jnp.zeros(2, bool), jnp.bool_(True)
    (_, _, _, energy, kinds, silent), _ = jax.lax.scan(step, start, jnp.arange(config.early.max_crossings))
    return StraightLine(
        distance,
        direction[0],
        *energy,
        is_partition_free=~kinds[0],
        is_clear=~jnp.any(kinds) & ~silent,
        is_over_limit=silent,
    )


@pytest.fixture(scope="module")
def bank():
    return load_bank("procedural:3?seed=7&preset=flat", num_houses=3)


def some_ends(rng, bank, house):
    """Places anywhere in a house's rooms, and of what is there; the latter belong to the body that they are of."""
    start, geometry = np.asarray(bank.navigation.start[house]), bank.geometry
    ids = np.asarray(geometry.instance_object[house])
    things = np.flatnonzero(ids >= 0)

    def place():
        thing = rng.choice(things, PAIRS)
        inside = np.asarray(geometry.instance_pose[house, thing, :, 3]) + np.array([0, 0, 0.05])
        free = rng.uniform([*start.min(axis=0)[:2], 0.1], [*start.max(axis=0)[:2], 2.4], (PAIRS, 3))
        own = rng.random(PAIRS) < 0.4
        return jnp.float32(np.where(own[:, None], inside, free)), jnp.int32(np.where(own, ids[thing], -1))

    (here, listener), (there, source) = place(), place()
    return here, there, source, listener


@pytest.mark.parametrize("max_crossings", [1, 16, *(pytest.param(n, marks=pytest.mark.slow) for n in (2, 4))])
def test_it_meets_what_single_casts_meet(bank, max_crossings):
    config, rng = (
        AudioConfig(receiver=Omni(), early=EarlyPaths(max_crossings=max_crossings)),
        np.random.default_rng(max_crossings),
    )

    @jax.jit
    def both(house, angle, *ends):
        body = bank.physics.body_pos[house], bank.physics.body_quat[house]
        scene = make_scene(bank, house, *body, *NOBODY, door_angle=jnp.full(bank.spec.num_doors, angle))

        def look(follow, here, there, emitter, own):
            return follow(scene, SoundSource(there, emitter), Listener(here, HEAD, own), config)

        return [jax.vmap(lambda *x, f=follow: look(f, *x))(*ends) for follow in (trace_straight_line, cast_by_cast)]

    silent, muffled, through_things, own = 0, 0, 0, 0
    for house in range(bank.num_houses):
        for angle in (0.0, 0.8):
            here, there, source, listener = some_ends(rng, bank, house)
            found, expected = both(jnp.int32(house), jnp.float32(angle), here, there, source, listener)
            others, _ = both(jnp.int32(house), jnp.float32(angle), here, there, source - 1000, listener)
            for name in StraightLine._fields:
                x, y = (np.asarray(getattr(line, name)) for line in (found, expected))
                np.testing.assert_allclose(x, y, rtol=1e-6, atol=0, err_msg=name)
            silent += np.sum(found.is_over_limit)
            muffled += np.sum(~np.asarray(found.is_partition_free) & ~np.asarray(found.is_over_limit))
            through_things += np.sum(np.any(np.asarray(found.object_transmission) < 1, axis=1))
            own += np.sum(
                np.any(np.asarray(found.object_transmission) != np.asarray(others.object_transmission), axis=1)
            )
    assert through_things > 50
    assert own > 20
    assert muffled > 50 if max_crossings == 16 else silent > 50
