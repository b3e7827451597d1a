"""Compilation from houses on disk to a bank on the device."""

import os
import statistics
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import jax
import jax.numpy as jnp

from benchmarks.cases.record import BenchSettings, Measurement, make_measurement
from home_mjx.houses import load_bank


def houses(settings: BenchSettings) -> Measurement:
    """Measure houses compiled per second: trees, colliders, navigation; nothing cached."""
    from home_mjx.datasets.registry import open_dataset
    from home_mjx.scene_compile.pipeline.compile import compile_house

    dataset = open_dataset(settings.root)
    loaded = [dataset.load_house(house_id) for house_id in dataset.house_ids[: settings.num_houses]]
    compile_house(loaded[0], dataset.metadata)  # warms up the compiler's Numba loops
    start = time.perf_counter()
    for house in loaded:
        compile_house(house, dataset.metadata)
    rate = len(loaded) / (time.perf_counter() - start)
    return make_measurement("compile/houses", rate, "houses/s", f"{settings.describe(len(loaded))}, nothing cached")


def bank(settings: BenchSettings) -> Measurement:
    """Measure seconds from a dataset with cached houses to a bank on the device."""
    from home_mjx.datasets.suncg.digests import clear_shared_indices

    load_bank(settings.root, num_houses=settings.num_houses)
    clear_shared_indices()
    start = time.perf_counter()
    made = jax.block_until_ready(load_bank(settings.root, num_houses=settings.num_houses))
    seconds = time.perf_counter() - start
    size = sum(leaf.nbytes for leaf in jax.tree.leaves(made)) / 2**20
    note = f"{settings.describe(made.num_houses)} from the cache, {size:.0f} MiB"
    return make_measurement("compile/bank", seconds, "s", note)


def dataset(settings: BenchSettings) -> Measurement:
    """Measure houses per second of worker processes that read, compile and write into an empty cache."""
    from home_mjx.datasets.registry import open_dataset
    from home_mjx.houses.job import compile_dataset

    root, workers = settings.root, os.cpu_count() or 1
    ids = open_dataset(root).house_ids[: settings.num_houses]
    with _empty_cache():
        summary = compile_dataset(root, ids, workers=workers, progress=True)
    note = f"{settings.describe(len(ids))}, {workers} processes and their start, models shared, {summary.failed} failed"
    return make_measurement("compile/dataset", summary.compiled / summary.seconds, "houses/s", note)


def cold(settings: BenchSettings) -> Measurement:
    """Measure seconds to read and compile the first house and to write it into an empty cache."""
    root = settings.root
    with _empty_cache():
        return make_measurement(
            "compile/cold", _first_house(root), "s", f"first of {settings.describe(1)}, empty cache"
        )


def cached(settings: BenchSettings) -> Measurement:
    """Measure seconds to load the first house from the cache as in a new process, including its integrity check."""
    from home_mjx.datasets.suncg.digests import clear_shared_indices

    _first_house(settings.root)
    clear_shared_indices()
    note = f"first of {settings.describe(1)}, from the cache"
    return make_measurement("compile/cached", _first_house(settings.root), "s", note)


def stream(settings: BenchSettings) -> Measurement:
    """Measure milliseconds of the slowest house exchange in a stream; the note reports the step time without it."""
    from home_mjx.datasets.registry import open_dataset
    from home_mjx.houses.stream import HouseStream
    from home_mjx.tasks.base.options import make_config
    from home_mjx.tasks.base.state import EnvParams
    from home_mjx.tasks.env.autoreset import AutoReset
    from home_mjx.tasks.env.household import HouseholdEnv

    slots = max(2, settings.num_houses // 2)
    if len(open_dataset(settings.root).house_ids) <= slots:  # none to exchange: generated ones
        settings = replace(settings, dataset=None, num_houses=2 * slots)
    with HouseStream(settings.root, num_slots=slots, capacity_factor=2.0) as houses:
        core = AutoReset(HouseholdEnv(make_config(sensors=("state", "goal"), episode_length=8)))
        step = jax.jit(core.step)
        states = jax.jit(core.reset)(EnvParams(houses.bank), jax.random.split(jax.random.key(0), settings.num_envs))
        actions = jnp.zeros((settings.num_envs, 4), jnp.float32)
        states = jax.block_until_ready(step(EnvParams(houses.bank), states, actions))
        waits, steps, end = [], [], time.perf_counter() + settings.seconds
        while time.perf_counter() < end or not waits:
            swaps, start = houses.num_swaps, time.perf_counter()
            bank = jax.block_until_ready(houses.advance(states.world.house))
            middle = time.perf_counter()
            states = jax.block_until_ready(step(EnvParams(bank), states, actions))
            steps.append(time.perf_counter() - middle)
            if houses.num_swaps > swaps:
                waits.append(middle - start)
    median, usual = (1e3 * statistics.median(times) for times in (waits, steps))
    note = (
        f"slowest of {len(waits)} exchanges, median {median:.1f} ms; a step without images takes {usual:.1f} ms, "
        f"the slowest {1e3 * max(steps):.1f} ms; {settings.describe(settings.num_houses)}"
    )
    return make_measurement("compile/stream", 1e3 * max(waits), "ms", note, num_envs=settings.num_envs)


def _first_house(root: Path) -> float:
    from home_mjx.datasets.registry import open_dataset
    from home_mjx.houses.house_cache import HouseCache

    start = time.perf_counter()
    dataset = open_dataset(root)
    HouseCache(dataset).load(dataset.house_ids[0])
    return time.perf_counter() - start


@contextmanager
def _empty_cache() -> Iterator[None]:
    """Set an empty cache folder for this process and its children."""
    from home_mjx.core.paths import CACHE_VARIABLE

    before = os.environ.get(CACHE_VARIABLE)
    with TemporaryDirectory() as folder:
        os.environ[CACHE_VARIABLE] = folder
        try:
            yield
        finally:
            os.environ.pop(CACHE_VARIABLE)
            if before is not None:
                os.environ[CACHE_VARIABLE] = before


CASES: dict[str, Callable[[BenchSettings], Measurement]] = {
    "houses": houses,
    "dataset": dataset,
    "cold": cold,
    "cached": cached,
    "bank": bank,
    "stream": stream,
}
