"""What cells hear before and after gates together; octaves, in halves, and axes side by side; host side."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np
from jaxtyping import Array, Float

from home_mjx.audio_jax.baking.fit import Tally
from home_mjx.audio_jax.baking.flights.flight import Gave
from home_mjx.audio_jax.baking.flights.stage import Heard
from home_mjx.audio_jax.baking.renewal import add_up, flux
from home_mjx.core.workers import usable_cores
from home_mjx.schema.compiled import BANDS

EARLY = 128  # bins, after which sound comes from everywhere
SUMS = ("lived", "lost", "moved", "through")  # of `Gave`, over all rays


def join(
    tally: Tally,
    cells: Heard,
    gates: Heard,
    given: Float[np.ndarray, "c bands g k"],
    passed: Float[np.ndarray, "g bands g k"],
) -> dict[str, np.ndarray]:
    """Fills a tally; directions from cell to cell, and sums over all rays.

    Args:
        tally: To fill.
        cells: What cells gave before any gate.
        gates: What gates gave before the next one.
        given: Energy that cells sent through each gate.
        passed: That went from gate to gate.
    """
    cells, gates = cells.on_host(), gates.on_host()
    early = given[..., :EARLY].mean(axis=1), passed[..., :EARLY].mean(axis=1)
    count, bands = len(tally.room), range(len(BANDS))
    halves = slice(count // 2), slice(count // 2, count)
    with ThreadPoolExecutor(usable_cores()) as pool:
        octaves = [
            [pool.submit(_heard, cells, gates, given[:, b], passed[:, b], partial(_energy, b, some)) for some in halves]
            for b in bands
        ]
        axes = [pool.submit(_heard, cells, gates, *early, partial(_way, axis, slice(count))) for axis in range(3)]
        added = [pool.submit(_add, tally, b, [part.result() for part in octaves[b]]) for b in bands]
        spans = list(pool.map(tally.spans, [axis.result() for axis in axes]))
        for each in added:
            each.result()
    total = np.maximum(tally.pair.sum(axis=3), 1e-30)[..., None]
    comes_from = np.round(np.clip(-127 * np.stack(spans, axis=-1) / total, -127, 127)).astype(np.int8)
    return _sums(cells, gates, given, passed) | {"comes_from": comes_from}


def _energy(octave: int, some: slice, gave: Gave) -> Array | np.ndarray:
    """What some cells hear in one octave."""
    return gave.energy[:, octave, some]


def _way(axis: int, some: slice, gave: Gave) -> Array | np.ndarray:
    """One component of the directions in which it comes, by energy."""
    return gave.way[:, some, :, axis]


def _heard(
    cells: Heard,
    gates: Heard,
    given: Float[np.ndarray, "c g k"],
    passed: Float[np.ndarray, "g g k"],
    read: Callable[[Gave], Array | np.ndarray],
) -> Float[np.ndarray, "c n whole"]:
    """What some cells hear of all, one part of it; through gates for as long as is given."""
    own, after = cells.whole(read), gates.whole(read)
    bins = given.shape[-1]
    own[..., :bins] += add_up(given, passed, after[..., :bins])
    return own


def _add(tally: Tally, octave: int, parts: Sequence[Float[np.ndarray, "c _ k"]]) -> None:
    """What all cells hear of all in one octave, given in parts."""
    heard = np.concatenate(parts, axis=1)
    tally.add(octave, np.maximum(heard, 0, out=heard), float(tally.bins * tally.metres))


def _sums(
    cells: Heard,
    gates: Heard,
    given: Float[np.ndarray, "c bands g k"],
    passed: Float[np.ndarray, "g bands g k"],
) -> dict[str, np.ndarray]:
    """Over all rays, those of gates as much as goes through these."""
    one, more = given.sum(axis=3), passed.sum(axis=3)
    total = np.stack([flux(one[:, band], more[:, band]).sum(axis=0) for band in range(len(BANDS))])
    sums = {}
    for name in SUMS:
        own, after = (x.whole(lambda gave, name=name: getattr(gave, name)).astype(float) for x in (cells, gates))
        sums[name] = own.sum(axis=0) + np.einsum("bg,gb...->b...", total, after)
    return sums
