"""From houses as read to houses on the device."""

import time
from collections.abc import Callable

import jax

from home_mjx.cli.cases.record import Record, Settings, make_record


def houses(settings: Settings) -> Record:
    """Houses compiled per second: trees, colliders, navigation; nothing cached."""
    from home_mjx.scene_compile.compile import compile_house
    from home_mjx.scene_compile.suncg import open_dataset

    dataset = open_dataset(settings.root)
    loaded = [dataset.load_house(house_id) for house_id in dataset.house_ids[: settings.num_houses]]
    compile_house(loaded[0], dataset.metadata)  # compiles the compiler's own loops
    start = time.perf_counter()
    for house in loaded:
        compile_house(house, dataset.metadata)
    rate = len(loaded) / (time.perf_counter() - start)
    return make_record("compile/houses", rate, "houses/s", f"{settings.describe(len(loaded))}, nothing cached")


def bank(settings: Settings) -> Record:
    """Seconds from a dataset whose houses are in the cache to a bank on the device."""
    from home_mjx.scene_compile.bank import HouseBank

    HouseBank.from_dataset(settings.root, limit=settings.num_houses)
    start = time.perf_counter()
    made = jax.block_until_ready(HouseBank.from_dataset(settings.root, limit=settings.num_houses))
    seconds = time.perf_counter() - start
    size = sum(leaf.nbytes for leaf in jax.tree.leaves(made)) / 2**20
    note = f"{settings.describe(made.num_houses)} from the cache, {size:.0f} MiB"
    return make_record("compile/bank", seconds, "s", note)


CASES: dict[str, Callable[[Settings], Record]] = {"houses": houses, "bank": bank}
