"""Compare sound in houses with an independent Monte Carlo on their triangles (`tests/helpers/triangle_oracle.py`).

Sources are in several rooms, because a single position is not representative of a house. The error of the oracle itself
is estimated from two independent halves of its particles.
"""

import sys
import time
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from acoustics import config_of, engine

sys.path.insert(0, str(Path(__file__).resolve().parent.parent / "tests" / "helpers"))

import triangle_oracle as oracle

from home_mjx.audio_jax import AudioConfig
from home_mjx.audio_jax.propagation.paths import air_attenuation

Errors = Callable[..., Iterator[dict[str, Any]]]
NEAREST = 1.0  # [m] minimum distance of source and ears; at shorter ones direct sound dominates


def sources_of(plan, count: int, height: np.ndarray) -> list[tuple[np.ndarray, int]]:
    """Return positions and rooms of sources: the plan's own, then one position per other room in turn."""
    rooms = [r for r in sorted(set(plan.rooms.tolist()) - {-1}) if r != plan.source_room]
    places = [(plan.starts[plan.rooms == room][0] + height, room) for room in rooms]
    middle = max(len(places) // max(count - 1, 1), 1)
    return [(plan.source, plan.source_room), *places[::middle]][:count]


def pairs_of(plan, surfaces, count: int, each: int, height: np.ndarray):
    """Yield per source: its position, the listeners, their rooms, doors between, and radii of uncut receivers."""
    ears, _ = plan.listeners(each)
    room = np.array([plan.room(place) for place in ears])
    free = oracle.free_radii(surfaces, ears)
    for place, own in sources_of(plan, count, height):
        use = (free > 0) & (np.linalg.norm(ears - place, axis=1) > NEAREST)
        yield place, ears[use], room[use], np.maximum(plan.all_hops[own][room[use]], 0), free[use]


def _engine(preset: str, seconds: float):
    """Return a function that computes energies (places, bins, bands) ear by ear, because all rays take gigabytes."""
    one = partial(engine, config=config_of(preset, seconds))

    @jax.jit
    def run(bank, source, ears, keys):
        return jax.lax.map(lambda x: one(bank, jnp.int32(0), source, *x), (ears, keys))

    return run


def judged(house, bank, plan, presets, seconds, particles, sources, each, height, errors: Errors):
    """Yield records of levels, T30 and EDT against the oracle, and of its halves against each other."""
    surfaces = oracle.surfaces_of(house, air_attenuation(AudioConfig()).astype(float))
    halves, ours, start = ([], []), {preset: [] for preset in presets}, time.perf_counter()
    doors, groups = [], []
    run = {preset: _engine(preset, seconds) for preset in presets}
    for number, (source, ears, room, hops, radius) in enumerate(pairs_of(plan, surfaces, sources, each, height)):
        for half, found in enumerate(halves):
            found.append(oracle.fly(surfaces, source, ears, seconds, 0.004, particles, radius, 2 * number + half))
        for preset in presets:
            keys = jax.random.split(jax.random.key(number), len(ears))
            energy = run[preset](bank, jnp.asarray(source, jnp.float32), jnp.asarray(ears, jnp.float32), keys)
            ours[preset].append(np.moveaxis(np.asarray(energy), 1, 2))
        doors.append(hops)
        groups.append(1000 * number + room)
        print(f"source {number}: {len(ears)} places, {time.perf_counter() - start:.0f} s", flush=True)
    first, second = (np.concatenate(half) for half in halves)
    how = np.concatenate(doors), 0.004, np.concatenate(groups)
    for record in errors(first, second, *how):
        yield {"truth": "oracle", "preset": "one half against the other", **record}
    for preset in presets:
        for record in errors((first + second) / 2, np.concatenate(ours[preset]), *how):
            yield {"truth": "oracle", "preset": preset, **record}
