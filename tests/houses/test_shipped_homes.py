"""Homes that the package ships compiled: they are those of the code, used as a cache is, and never used wrongly."""

import json
import runpy
import shutil
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from home_mjx.audio_jax.late_reverb.bake.field_cache import COARSE_BAKE, LateReverbBake
from home_mjx.houses.bakes import bake_entry
from home_mjx.houses.house_cache import HouseCache
from home_mjx.houses.house_set import HouseSet
from home_mjx.houses.load import DEFAULT_DATASET, NUM_HOUSES
from home_mjx.houses.shipped import INDEX_MEMBER, ShippedHouses, decode_arrays, encode_arrays
from home_mjx.scene_compile import CompileOptions, NavigationOptions
from home_mjx.scene_compile.pipeline.compile import DEFAULT_OPTIONS
from home_procgen import shipped as shipped_module
from home_procgen.plugin import ProceduralDataset
from home_procgen.shipped import ARCHIVE, ShippedHomes

REBUILD = "run `python scripts/build_homes.py`"
NAME = DEFAULT_DATASET.partition(":")[2]
MAX_BYTES = 9_000_000  # of the archive; the wheel has 25 MB at most


@pytest.fixture
def dataset(tmp_path, monkeypatch) -> ProceduralDataset:
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))
    return ProceduralDataset(NAME)


@pytest.fixture
def compiled(monkeypatch) -> list[str]:
    """Ids of houses that would be compiled, which stops there."""
    ids = []

    def compile_house(self, house_id, entry, broken):
        ids.append(house_id)
        raise KeyboardInterrupt

    monkeypatch.setattr(HouseCache, "_compile", compile_house)
    return ids


def smallest(dataset: ProceduralDataset) -> str:
    rows = ShippedHouses(dataset.shipped).houses.values()
    return min(rows, key=lambda row: len(row.models)).id


def damaged_copy(source: Path, target: Path, prefix: str) -> Path:
    """Copy an archive and change a byte in the middle of each member whose name begins with the prefix."""
    data = bytearray(source.read_bytes())
    with zipfile.ZipFile(source) as archive:
        for info in archive.infolist():
            if info.filename.startswith(prefix):
                data[info.header_offset + 30 + len(info.filename) + info.compress_size // 2] ^= 0xFF
    target.write_bytes(data)
    return target


def test_the_shipped_homes_are_those_of_this_code(dataset):
    """A digest of compiler, generator and models notices a forgotten rebuild."""
    assert ARCHIVE.stat().st_size < MAX_BYTES
    filmed = HouseSet(dataset, num_houses=3, split="val").house_ids  # by the demo
    ids = {row.id for row in ShippedHouses(dataset.shipped).houses.values()}
    assert ids == {*HouseSet(dataset, num_houses=NUM_HOUSES).house_ids, *filmed}, REBUILD


def test_a_shipped_home_is_copied_into_the_cache_and_not_generated(dataset, compiled):
    cache = HouseCache(dataset)
    house = cache.load(name := smallest(dataset))
    assert compiled == []
    assert not (dataset.root / "house").exists()
    assert all(Path(path).is_file() for path in house.materials.texture if path)
    fine = bake_entry(LateReverbBake(), house)
    assert fine.is_file(), REBUILD
    assert not bake_entry(COARSE_BAKE, house).exists()
    assert cache.entry_path(name).is_file()
    again = HouseCache(dataset)
    again._shipped = ShippedHouses(replace(dataset.shipped, path=Path("missing")))
    again._shipped.houses = dict(cache._shipped.houses)  # without members: only the cache has it
    read = again.load(name)
    assert read.materials.texture == house.materials.texture
    assert read.models.keys() == house.models.keys()


@pytest.mark.parametrize(
    ("variant", "options"),
    [
        ("65536", CompileOptions(navigation=NavigationOptions(cell=0.2))),
        ("65536?detail=low", DEFAULT_OPTIONS),
    ],
)
def test_homes_of_other_options_are_compiled(tmp_path, monkeypatch, compiled, variant, options):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path))
    other = ProceduralDataset(variant)
    monkeypatch.setattr(ProceduralDataset, "prepare", lambda self, ids, progress=False: None)
    with pytest.raises(KeyboardInterrupt):
        HouseCache(other, options).load(other.house_ids[0])
    assert compiled == [other.house_ids[0]]


def test_homes_of_other_code_are_not_used(dataset, monkeypatch):
    monkeypatch.setattr(shipped_module, "hash_inputs", lambda: b"edited")
    assert ShippedHouses(dataset.shipped).houses == {}


def test_the_digest_follows_every_module_of_the_generator(tmp_path, monkeypatch):
    root = tmp_path / "home_procgen"
    shutil.copytree(shipped_module.ROOT, root, ignore=shutil.ignore_patterns("__pycache__", "homes.zip"))
    monkeypatch.setattr(shipped_module, "ROOT", root)
    hashed = shipped_module.hash_inputs.__wrapped__
    before = hashed()
    module = root / "plan" / "home.py"
    module.write_text(module.read_text() + "# a word\n")
    assert hashed() == before
    module.write_text(module.read_text() + "A_NUMBER = 1\n")
    assert hashed() != before


@pytest.mark.parametrize("prefix", ["houses/", "models/"])
def test_a_damaged_archive_costs_only_time(dataset, compiled, monkeypatch, tmp_path, caplog, prefix):
    source = dataset.shipped
    path = damaged_copy(source.path, tmp_path / "homes.zip", prefix)
    monkeypatch.setattr(ProceduralDataset, "shipped", replace(source, path=path))
    monkeypatch.setattr(ProceduralDataset, "prepare", lambda self, ids, progress=False: None)
    cache = HouseCache(dataset)
    with pytest.raises(KeyboardInterrupt):
        cache.load(name := smallest(dataset))
    assert compiled == [name]
    assert "is damaged, it is compiled instead" in caplog.text


def test_an_archive_that_cannot_be_read_is_named_once(dataset, tmp_path, caplog):
    path = tmp_path / "homes.zip"
    path.write_bytes(ARCHIVE.read_bytes()[:1000])
    assert ShippedHouses(replace(dataset.shipped, path=path)).houses == {}
    assert "shipped houses are damaged" in caplog.text
    assert ShippedHouses(replace(dataset.shipped, path=tmp_path / "no.zip")).houses == {}


@pytest.mark.slow
def test_building_again_gives_the_same_archive(tmp_path, monkeypatch):
    build = runpy.run_path(str(Path(__file__).parents[2] / "scripts" / "build_homes.py"))["build"]
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))
    build(tmp_path / "homes.zip")
    with zipfile.ZipFile(ARCHIVE) as shipped, zipfile.ZipFile(tmp_path / "homes.zip") as made:
        assert json.loads(shipped.read(INDEX_MEMBER)) == json.loads(made.read(INDEX_MEMBER))
        assert shipped.namelist() == made.namelist()
        assert [name for name in made.namelist() if shipped.read(name) != made.read(name)] == []


def test_coded_arrays_are_exact():
    rng = np.random.default_rng(0)
    arrays = {
        "field": rng.integers(0, 1 << 16, (5, 3)).astype(np.uint16),
        "level": rng.normal(size=(4, 3, 2)).astype(np.float16),
        "row": np.arange(3, dtype=np.uint16),
        "none": np.zeros((0, 3), np.float16),
    }
    coded, notes = encode_arrays(arrays, {"id": "a"})
    plain, own = decode_arrays(coded, notes)
    assert own == {"id": "a"}
    for name, array in arrays.items():
        assert plain[name].dtype == array.dtype
        assert np.array_equal(plain[name], array), name


def test_sources_are_hashable_and_equal_for_equal_folders(dataset):
    assert isinstance(dataset.shipped, ShippedHomes)
    assert len({dataset.shipped, ProceduralDataset(NAME).shipped}) == 1
