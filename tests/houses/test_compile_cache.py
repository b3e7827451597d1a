import dataclasses
import multiprocessing
import os
import signal
import time
import zipfile

import numpy as np
import pytest
from PIL import Image
from tiny_arch import arch_path, write_tiny_v2
from tiny_dataset import DOOR, HOUSE_ID, TABLE, edit_house, write_tiny_dataset

from home_mjx.core.array_store import READ_ERRORS, flatten, read_entry, read_notes, write_entry
from home_mjx.core.paths import cache_folder
from home_mjx.datasets.registry import open_dataset
from home_mjx.datasets.suncg.digests import SuncgDigests
from home_mjx.errors import DatasetError
from home_mjx.houses import house_cache as cache
from home_mjx.houses import load_bank
from home_mjx.houses.house_cache import load_compiled
from home_mjx.houses.version import VERSION_FOLDER, prepare_folder
from home_mjx.scene_compile.collision.movables import MovableOptions
from home_mjx.scene_compile.pipeline.compile import DEFAULT_OPTIONS, CompileOptions, compile_house


@pytest.fixture
def root(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))
    return write_tiny_dataset(tmp_path / "data")


@pytest.fixture
def compiles(monkeypatch) -> list[str]:
    """Ids of the houses that were really compiled."""
    done = []

    def counted(house, metadata, options):
        done.append(house.id)
        return compile_house(house, metadata, options)

    monkeypatch.setattr(cache, "compile_house", counted)
    return done


def load(root, options=DEFAULT_OPTIONS):
    return load_compiled(open_dataset(root), HOUSE_ID, options)


def assert_equal(a, b):
    """Bit for bit, types included."""
    (arrays, notes), (other_arrays, other_notes) = (
        flatten(a, frozenset(("models",))),
        flatten(b, frozenset(("models",))),
    )
    assert arrays.keys() == other_arrays.keys()
    for name, array in arrays.items():
        assert array.dtype == other_arrays[name].dtype, name
        assert array.tobytes() == other_arrays[name].tobytes(), name
        assert array.shape == other_arrays[name].shape, name
    assert notes == other_notes
    if hasattr(a, "models"):
        assert a.models.keys() == b.models.keys()
        for key in a.models:
            assert_equal(a.models[key], b.models[key])


def entries(kind: str = "houses") -> list:
    return sorted(cache_folder().glob(f"*/{kind}/*.zip"))


def test_what_comes_back_is_what_was_compiled(root, compiles):
    first, second = load(root), load(root)
    assert compiles == [HOUSE_ID]
    assert_equal(first, second)
    dataset = open_dataset(root)
    assert_equal(second, compile_house(dataset.load_house(HOUSE_ID), dataset.metadata))


def test_the_real_house_comes_back_and_fast(suncg_root, tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path))
    seconds, loaded = [], []
    for _ in range(2):
        start = time.perf_counter()
        dataset = open_dataset(suncg_root)
        loaded.append(load_compiled(dataset, dataset.house_ids[0]))
        seconds.append(time.perf_counter() - start)
    assert seconds[1] < seconds[0] / 3
    assert_equal(*loaded)


def test_models_are_stored_once(root, tmp_path):
    load(root)
    count = len(entries("models"))
    edit_house(root, lambda house: house["levels"][0]["nodes"][0].update(roomTypes=["Bedroom"]))
    load(root)
    assert len(entries("houses")) == 2
    assert len(entries("models")) == count


def replace_in(path, old: str, new: str):
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))


@pytest.mark.parametrize(
    "change",
    [
        lambda root: edit_house(root, lambda house: house["levels"][0]["nodes"][2].pop("materials")),
        lambda root: replace_in(root / "object" / TABLE / f"{TABLE}.mtl", "0.8", "0.7"),
        lambda root: replace_in(root / "metadata" / "ModelCategoryMapping.csv", "dining_table", "coffee_table"),
    ],
)
def test_a_changed_input_is_compiled_again(root, compiles, change):
    load(root)
    change(root)
    load(root)
    assert len(compiles) == 2


def rename_model(root, new: str):
    folder = root / "object" / new
    (root / "object" / TABLE).rename(folder)
    (folder / f"{TABLE}.obj").rename(folder / f"{new}.obj")
    edit_house(root, lambda house: house["levels"][0]["nodes"][2].update(modelId=new))


@pytest.mark.parametrize("name", ["s__12", "my table", 'quo"te', "tüsch", "1+1=2"])
def test_a_model_of_any_legal_name_is_an_input(root, compiles, name):
    rename_model(root, name)
    load(root)
    load(root)
    assert len(compiles) == 1
    replace_in(root / "object" / name / f"{TABLE}.mtl", "0.8", "0.7")
    load(root)
    assert len(compiles) == 2


def test_a_variant_named_by_itself_is_an_input(root, compiles):
    """Its files lie in the folder of its base."""
    edit_house(root, lambda house: house["levels"][0]["nodes"][3].update(modelId=f"{DOOR}_0", state=0))
    load(root)
    replace_in(root / "object" / DOOR / f"{DOOR}.mtl", "0.5", "0.6")
    load(root)
    assert len(compiles) == 2


def test_a_material_library_elsewhere_is_an_input(root, compiles):
    shared = root / "object" / "shared.mtl"
    shared.write_bytes((root / "object" / TABLE / f"{TABLE}.mtl").read_bytes())
    replace_in(root / "object" / TABLE / f"{TABLE}.obj", f"mtllib {TABLE}.mtl", "mtllib ../shared.mtl")
    replace_in(shared, "../../texture//", "../texture/")
    load(root)
    replace_in(shared, "0.8", "0.7")
    load(root)
    assert len(compiles) == 2


def test_an_architecture_file_is_an_input(tmp_path, monkeypatch, compiles):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))
    root = write_tiny_v2(tmp_path / "data")
    load(root)
    path = arch_path(root, HOUSE_ID)
    path.write_text(path.read_text() + "\n")
    load(root)
    assert len(compiles) == 2


@pytest.mark.parametrize("change", ["other picture", "missing"])
def test_a_changed_texture_never_serves_an_old_house(root, compiles, change):
    """The texture is named by the MTL of a model, not by the house."""
    before = load(root)
    path = root / "texture" / "wood_1.png"
    assert str(path) in before.materials.texture
    path.unlink()
    if change == "missing":
        with pytest.raises(DatasetError, match="wood_1"):
            load(root)
        return
    Image.new("RGB", (2, 2), (0, 0, 255)).save(path)
    load(root)
    load(root)
    assert len(compiles) == 2


def test_model_names_that_lead_elsewhere_are_not_looked_at(root, tmp_path):
    """Outside the dataset lies a pipe, which nobody could read to its end."""
    os.mkfifo(tmp_path / "pipe")
    edit_house(root, lambda house: house["levels"][0]["nodes"][2].update(modelId="../../pipe"))
    inputs = SuncgDigests(root)
    assert inputs.house(HOUSE_ID) == inputs.house(HOUSE_ID)


def test_changed_options_are_compiled_again(root, compiles):
    load(root)
    load(root, CompileOptions(movables=MovableOptions(max_bodies=0)))
    assert len(compiles) == 2


def test_a_moved_dataset_is_found_again(root, compiles, tmp_path):
    before = load(root)
    moved = root.rename(tmp_path / "elsewhere")
    after = load(moved)
    assert compiles == [HOUSE_ID]
    assert [t for t in after.materials.texture if t] == [
        t.replace(str(root), str(moved)) for t in before.materials.texture if t
    ]
    assert all(os.path.isfile(t) for t in after.materials.texture if t)


@pytest.mark.parametrize("kind", ["houses", "models"])
@pytest.mark.parametrize("damage", ["cut", "flip", "empty", "text"])
def test_broken_entries_are_found_and_made_again(root, compiles, kind, damage):
    good = load(root)
    for path in entries(kind):
        data = bytearray(path.read_bytes())
        if damage == "flip":
            data[len(data) // 2] ^= 0xFF
        new = {"cut": data[: len(data) // 2], "flip": data, "empty": b"", "text": b"no archive"}[damage]
        path.write_bytes(new)
    assert_equal(load(root), good)
    assert len(compiles) == 2
    assert_equal(load(root), good)
    assert len(compiles) == 2


def test_a_missing_model_is_made_again(root, compiles):
    good = load(root)
    entries("models")[0].unlink()
    assert_equal(load(root), good)
    assert len(compiles) == 2


def test_an_unwritable_folder_only_costs_time(root, compiles, tmp_path, monkeypatch):
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "file" / "cache"))
    assert_equal(load(root), load(root))
    assert len(compiles) == 2


def _write_forever(path):
    arrays = {"a": np.zeros((1000, 1000))}
    while True:
        write_entry(path, arrays, {})


def test_killed_writers_leave_no_half_entry(tmp_path):
    path = tmp_path / "entry.zip"
    context = multiprocessing.get_context("spawn")  # JAX may run in this process: a fork of it could hang
    for _ in range(3):
        path.unlink(missing_ok=True)
        writer = context.Process(target=_write_forever, args=(path,))
        writer.start()
        while not path.exists():
            time.sleep(0.001)
        time.sleep(0.02)
        os.kill(writer.pid, signal.SIGKILL)
        writer.join()
        arrays, _ = read_entry(path)
        assert arrays["a"].shape == (1000, 1000)
    assert [p.name for p in tmp_path.glob("*.zip")] == ["entry.zip"]


def old_version(name: str, days: float):
    folder = cache_folder() / name
    (folder / "houses").mkdir(parents=True)
    (folder / "houses" / "x.zip").write_text("x")
    os.utime(folder, times=(time.time() - days * 86400,) * 2)
    return folder


def test_a_new_version_drops_those_unused_for_a_month(root):
    stale, recent = old_version("v1-0123456789ab", 31), old_version("v1-ba9876543210", 29)
    half_removed = old_version(".discarded-v1-aaaaaaaaaaaa", 0)
    others = [old_version(name, 99) for name in ("generated-v1", "v1-short", "mine")]
    load(root)
    assert not stale.exists()
    assert not half_removed.exists()
    assert all(folder.exists() for folder in [recent, *others])


def test_a_version_in_use_is_not_stale(root):
    load(root)
    (folder,) = [path for path in cache_folder().iterdir() if VERSION_FOLDER.fullmatch(path.name)]
    os.utime(folder, times=(0, 0))
    load(root)
    assert time.time() - folder.stat().st_mtime < 60


def test_leftovers_of_killed_writers_are_removed(root):
    load(root)
    folder = entries()[0].parent
    old, new = (folder / f".{digit * 32}.tmp" for digit in "01")
    for path in (old, new):
        path.write_text("half")
    os.utime(old, times=(0, 0))
    prepare_folder()
    assert not old.exists()
    assert new.exists()


def test_no_flipped_byte_passes(tmp_path):
    """Every byte of a small entry: it is found broken, or reads as before (in what the format leaves open)."""
    path = tmp_path / "a.zip"
    write_entry(path, {"a": np.arange(3, dtype=np.int16)}, {"n": 1})
    data = path.read_bytes()
    for at in range(len(data)):
        path.write_bytes(data[:at] + bytes([data[at] ^ 0x55]) + data[at + 1 :])
        try:
            arrays, notes = read_entry(path)
        except READ_ERRORS:
            continue
        assert arrays["a"].tolist() == [0, 1, 2]
        assert notes == {"n": 1}


def test_entries_keep_every_kind_of_array(tmp_path, rng):
    arrays = {
        "empty": np.zeros((0, 3)),
        "scalar": np.float32(2.5)[None][0:1].reshape(()),
        "flags": rng.random((3, 5)) < 0.5,
        "small": np.arange(7, dtype=np.uint16).reshape(7, 1),
        "strided": rng.random((4, 6))[:, ::2],
    }
    write_entry(tmp_path / "a.zip", arrays, {"x": [1, "ü"]})
    back, notes = read_entry(tmp_path / "a.zip")
    assert notes == read_notes(tmp_path / "a.zip") == {"x": [1, "ü"]}
    assert back.keys() == arrays.keys()
    for name, array in arrays.items():
        assert back[name].dtype == array.dtype
        assert back[name].flags.aligned
        assert back[name].flags.writeable
        np.testing.assert_array_equal(back[name], array)


def test_entries_are_archives_that_others_read_too_and_only_as_they_were_written(tmp_path, rng):
    """Those of older versions, whose data begins anywhere; and not what has a comment, or a third member."""
    path, x = tmp_path / "a.zip", rng.random(5)
    write_entry(path, {"x": x}, {})
    with zipfile.ZipFile(path) as archive:
        assert archive.testzip() is None
        notes, data = (archive.read(name) for name in ("notes.json", "data"))
    assert np.frombuffer(data)[:5].tolist() == x.tolist()
    for more in range(64):
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("notes.json", notes + b" " * more)
            archive.writestr("data", data)
        found = read_entry(path)[0]["x"]
        assert found.flags.aligned
        assert found.tolist() == x.tolist()
    with zipfile.ZipFile(path, "a") as archive:
        archive.comment = b"mine"
    with pytest.raises(READ_ERRORS):
        read_entry(path)
    write_entry(path, {"x": x}, {})
    with zipfile.ZipFile(path, "a") as archive:
        archive.writestr("more", b"")
    with pytest.raises(READ_ERRORS):
        read_entry(path)


def test_folder_follows_the_environment(monkeypatch, tmp_path):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "own"))
    assert cache_folder() == tmp_path / "own"
    monkeypatch.delenv("HOME_MJX_CACHE")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert cache_folder() == tmp_path / "home_mjx"
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setenv("HOME", str(tmp_path))
    assert cache_folder() == tmp_path / ".cache" / "home_mjx"


def test_a_bank_of_a_dataset_holds_its_houses(root, compiles):
    bank = load_bank(root, ids=[HOUSE_ID, HOUSE_ID])
    assert bank.num_houses == 2
    assert load_bank(open_dataset(root), num_houses=1).num_houses == 1
    assert compiles == [HOUSE_ID]
    fields = {f.name: np.asarray(getattr(bank.physics, f.name)) for f in dataclasses.fields(bank.physics)}
    for name, values in fields.items():
        np.testing.assert_array_equal(values[0], values[1], err_msg=name)
