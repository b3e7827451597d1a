"""Compile and bake the default homes and write the archive that the package ships, `home_procgen/data/homes.zip`.

python scripts/build_homes.py

It takes some four minutes of CPU time. Run it after every change of the compiler, the generator or the baker.
"""

import os
import tempfile
from pathlib import Path

from home_mjx.audio_jax.late_reverb.bake.field_cache import LateReverbBake
from home_mjx.bank.bank import HouseBank
from home_mjx.core.array_store import Arrays, JsonFields, flatten, pack_entry, read_entry
from home_mjx.core.paths import CACHE_VARIABLE, cache_folder
from home_mjx.core.progress import say
from home_mjx.env_factory import core_of
from home_mjx.houses.bakes import add_bakes, bake_entry
from home_mjx.houses.house_cache import HOUSES, MODELS, HouseCache
from home_mjx.houses.house_set import HouseSet
from home_mjx.houses.load import DEFAULT_DATASET, NUM_HOUSES
from home_mjx.houses.shipped import ShippedHouse, write_archive
from home_mjx.registry import find_spec, load_entry_point
from home_procgen.plugin import ProceduralDataset
from home_procgen.shipped import ARCHIVE, ShippedHomes

NUM_FILMED = 3  # of `home-mjx demo`


class UnshippedDataset(ProceduralDataset):
    """The default dataset without its shipped homes, so that all are compiled."""

    reader = ProceduralDataset.reader
    shipped = None


def build(path: Path, num_houses: int = NUM_HOUSES, num_filmed: int = NUM_FILMED) -> None:
    """Write the archive of the default homes; the cache folder should be empty.

    Args:
        path: The archive.
        num_houses: Homes of `make` and of the demo.
        num_filmed: Homes of the split `val` that the demo films.
    """
    dataset = UnshippedDataset(DEFAULT_DATASET.partition(":")[2])
    source = ProceduralDataset(DEFAULT_DATASET.partition(":")[2]).shipped
    assert source is not None
    options = core_of(load_entry_point(find_spec("PointNav-v0").entry_point), {})[1]
    filmed = HouseSet(dataset, num_houses=num_filmed, split="val").house_ids if num_filmed else ()
    ids = dict.fromkeys((*HouseSet(dataset, num_houses=num_houses).house_ids, *filmed))
    chosen = HouseSet(dataset, tuple(ids), options=options)
    cache = chosen.open_cache()
    houses = chosen.load(True)
    add_bakes(HouseBank.from_compiled(houses), houses, bake := LateReverbBake(), True)
    rows, members = {}, {}
    for house in houses:
        entry, record = cache.entry_path(house.id), bake_entry(bake, house)
        baked = record.relative_to(cache_folder()).as_posix()
        arrays, notes = read_entry(entry)
        textures, notes["texture_paths"] = sorted(notes["texture_paths"]), {}  # drawn, so they fit without a digest
        key = cache.entry_name(house.id, source.digest())
        rows[key] = ShippedHouse(house.id, tuple(dict.fromkeys(house.instances.model)), tuple(textures), (baked,))
        members[f"{HOUSES}/{key}.zip"] = arrays, notes
        members[baked] = read_entry(record)
        members |= pack_models(cache, source, rows[key].models)
    write_archive(path, source, rows, members)
    say(f"{path.name}: {path.stat().st_size / 1e6:.1f} MB", True)


def pack_models(cache: HouseCache, source: ShippedHomes, keys: tuple[str, ...]) -> dict[str, tuple[Arrays, JsonFields]]:
    """Return the entries, by member, of those models that differ from the library's, or that the library lacks."""
    found = {}
    for key in keys:
        own, path = source.library_model(key), cache.model_path(key)
        entry = flatten(cache.model(key))
        if own is None or pack_entry(path, *flatten(own)) != pack_entry(path, *entry):
            found[f"{MODELS}/{path.name}"] = entry
    return found


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        os.environ[CACHE_VARIABLE] = folder
        build(ARCHIVE)
