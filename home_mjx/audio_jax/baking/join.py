"""What cells hear before and after gates together; octaves and axes side by side, each in a thread; host side."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from jaxtyping import Float

from home_mjx.audio_jax.baking.fit import Tally
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
    with ThreadPoolExecutor(usable_cores()) as pool:
        octaves = pool.map(
            lambda band: _hear(tally, cells, gates, given[:, band], passed[:, band], band), range(len(BANDS))
        )
        axes = pool.map(lambda axis: _along(tally, cells, gates, *early, axis), range(3))
        way = [*octaves, *axes][len(BANDS) :]
    whole = np.maximum(tally.pair.sum(axis=3), 1e-30)[..., None]
    comes_from = np.round(np.clip(-127 * np.stack(way, axis=-1) / whole, -127, 127)).astype(np.int8)
    return _sums(cells, gates, given, passed) | {"comes_from": comes_from}


def _hear(
    tally: Tally,
    cells: Heard,
    gates: Heard,
    given: Float[np.ndarray, "c g k"],
    passed: Float[np.ndarray, "g g k"],
    band: int,
) -> None:
    """One octave."""
    own, after = (x.whole(lambda gave: gave.energy[:, band, : len(tally.room)]) for x in (cells, gates))
    own += add_up(given, passed, after)
    tally.add(band, np.maximum(own, 0, out=own), float(tally.bins * tally.metres))


def _along(
    tally: Tally,
    cells: Heard,
    gates: Heard,
    given: Float[np.ndarray, "c g k"],
    passed: Float[np.ndarray, "g g k"],
    axis: int,
) -> Float[np.ndarray, "c c s"]:
    """One component of the directions in which sound comes, by energy, over each span."""
    way, after = (x.whole(lambda gave: gave.way[:, : len(tally.room), :, axis]) for x in (cells, gates))
    way[..., :EARLY] += add_up(given, passed, after[..., :EARLY])
    return tally.spans(way)


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
