"""Errors are caught by the built-in classes that users' code names, and keep their text, place and hint on the way."""

import copy
import errno
import inspect
import os
import pickle
from pathlib import Path

import pytest
from tiny_dataset import HOUSE_ID, TABLE, write_tiny_dataset

import home_mjx
from home_mjx import errors
from home_mjx.core.files import MAX_BYTES, read_bytes
from home_mjx.core.jsonable import MAX_TEXT_LENGTH, from_json, to_json
from home_mjx.datasets import open_dataset
from home_mjx.houses import HouseCache
from home_mjx.raycast_render import LitShader
from home_mjx.registry import EnvSpec
from home_mjx.tasks.base.options import make_config

BUILT_IN = {
    errors.HomeMjxError: set(),
    errors.DatasetError: {ValueError},
    errors.MissingFileError: {ValueError, FileNotFoundError},
    errors.UnknownIdError: {ValueError, KeyError},
    errors.ConfigError: {ValueError},
    errors.UnknownNameError: {ValueError, KeyError},
    errors.UnknownMemberError: {ValueError, KeyError, AttributeError},
    errors.OutOfRangeError: {ValueError, IndexError},
    errors.CapacityError: {ValueError},
    errors.BackendError: {RuntimeError},
}
CAUGHT = (ValueError, KeyError, IndexError, AttributeError, OSError, FileNotFoundError, RuntimeError, TypeError)
EXPECTED = "expected 3, got 1 (in room.obj, at line 7). Export it again."


def test_every_class_is_in_the_table_of_the_module():
    classes = {value for _, value in inspect.getmembers(errors, inspect.isclass) if value.__module__ == errors.__name__}
    assert classes == set(BUILT_IN)
    table = errors.__doc__ or ""
    assert [c.__name__ for c in classes - {errors.HomeMjxError} if f"`{c.__name__}`" not in table] == []


@pytest.mark.parametrize("kind", BUILT_IN)
def test_built_in_classes_catch_it(kind: type[errors.HomeMjxError]):
    wanted = BUILT_IN[kind] | ({OSError} if FileNotFoundError in BUILT_IN[kind] else set())
    assert {c for c in CAUGHT if issubclass(kind, c)} == wanted


@pytest.mark.parametrize("kind", BUILT_IN)
@pytest.mark.parametrize("way", [lambda e: e, copy.copy, copy.deepcopy, lambda e: pickle.loads(pickle.dumps(e))])
def test_text_and_place_survive(kind: type[errors.HomeMjxError], way):
    """`KeyError` would quote its text, and `OSError` write an error number before it."""
    error = way(kind("expected 3, got 1", file=Path("room.obj"), element="line 7", hint="Export it again."))
    assert type(error) is kind
    assert str(error) == EXPECTED
    assert error.args == (EXPECTED,)
    assert (error.message, error.file, error.element, error.hint) == (
        "expected 3, got 1",
        "room.obj",
        "line 7",
        "Export it again.",
    )


@pytest.mark.parametrize("kind", BUILT_IN)
def test_without_place_or_hint_it_is_its_message(kind: type[errors.HomeMjxError]):
    assert str(kind("nothing fits")) == "nothing fits"


def test_what_a_file_holds_can_always_be_printed():
    """Half of a pair of code units, as JSON can hold one; found by fuzzing files of episodes."""
    error = errors.DatasetError("house \ud800 is not in the bank", file="a", element="line \udfff", hint="\ud800!")
    assert str(error).encode() == rb"house \ud800 is not in the bank (in a, at line \udfff). \ud800!"
    assert str(error) == error.args[0]


def test_missing_files_have_name_and_number(tmp_path: Path):
    with pytest.raises(FileNotFoundError) as caught:
        read_bytes(tmp_path / "none.obj")
    assert (caught.value.filename, caught.value.errno) == (str(tmp_path / "none.obj"), errno.ENOENT)
    again = pickle.loads(pickle.dumps(caught.value))
    assert (again.filename, again.errno) == (caught.value.filename, errno.ENOENT)


def test_a_refused_file_keeps_its_own_message(tmp_path: Path):
    """Refused inside the block that turns the system's errors into ours: it must not be wrapped a second time."""
    large = tmp_path / "large.obj"
    large.touch()
    os.truncate(large, MAX_BYTES + 1)
    with pytest.raises(errors.DatasetError) as caught:
        read_bytes(large)
    assert caught.value.message == f"file has {MAX_BYTES + 1} bytes, at most {MAX_BYTES} are read"
    assert not isinstance(caught.value, OSError)


def test_unknown_ids_and_missing_folders(tmp_path: Path):
    with pytest.raises(FileNotFoundError, match="dataset root is not a folder"):
        open_dataset(tmp_path / "nowhere")
    with pytest.raises(FileNotFoundError, match="folder contains no house"):
        open_dataset(tmp_path)
    dataset = open_dataset(write_tiny_dataset(tmp_path))
    with pytest.raises(KeyError) as caught:
        dataset.load_house("none")
    assert str(caught.value).startswith("unknown house `none` (in ")
    with pytest.raises(errors.DatasetError, match="not a folder") as refused:
        open_dataset(tmp_path / "house" / HOUSE_ID / "house.json")
    assert not isinstance(refused.value, FileNotFoundError)


@pytest.mark.parametrize(("name", "kind"), [("PointNav-v9", KeyError), ("pointnav", ValueError)])
def test_unknown_environments(name: str, kind: type[Exception]):
    with pytest.raises(kind, match=f"^unknown environment `{name}`"):
        home_mjx.make(name)


def test_an_option_of_a_shader_belongs_into_the_shader():
    for options, text in (
        (
            {"shader": "lit", "density": 1.0},
            r"^unknown option `density`.*num_lights, .*exposure, reflections, .*as in shader=LitShader\(num_lights=",
        ),
        ({"shader": LitShader(ambient=0.1), "num_lights": 2}, r"option of the shader: shader=LitShader\(num_lights="),
        ({"shader": "fog", "density": 1.0}, r"^unknown shader `fog`.*Known: baked, fast, lit"),
        ({"shader": "fast", "widht": 3}, r"Did you mean `width`\?.*The shader `fast` has no options"),
    ):
        with pytest.raises(errors.ConfigError, match=text):
            make_config(**options)


def test_unknown_options():
    with pytest.raises(KeyError, match=r"^unknown option `widht`.*Did you mean `width`"):
        home_mjx.make("PointNav-v0", widht=3)


def test_a_missing_model_is_not_taken_for_a_missing_cache_entry(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The cache looks for `FileNotFoundError` and `ValueError`, which our own errors are now as well."""
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))
    root = write_tiny_dataset(tmp_path / "data")
    (root / "object" / TABLE / f"{TABLE}.obj").unlink()
    cache = HouseCache(open_dataset(root))
    for ask in (cache.load, cache.notes):
        with pytest.raises(errors.MissingFileError, match=f"model `{TABLE}` has no OBJ file"):
            ask(HOUSE_ID)
    with pytest.raises(errors.UnknownIdError, match="unknown house `none`"):
        cache.load("none")
    assert cache.num_compiled == 0


def test_a_wrong_value_in_json_keeps_its_own_message():
    """Refused inside the block that refuses broken JSON."""
    text = '{"__type__": "home_mjx.physics.base.config:PhysicsConfig", "num_agents": 0}'
    with pytest.raises(errors.ConfigError, match=r"^expected a whole number of at least 1, got 0"):
        from_json(text)
    with pytest.raises(errors.ConfigError, match=r"^cannot be read as options: "):
        from_json("{")


def test_options_that_are_too_long_are_refused_before_they_are_parsed():
    """One of 115 MB, lists of forty within lists of forty, took 1.6 GiB and sixteen seconds."""
    with pytest.raises(errors.ConfigError, match=rf"^options text has {MAX_TEXT_LENGTH + 1} characters, at most"):
        from_json("[" * (MAX_TEXT_LENGTH + 1))
    with pytest.raises(errors.ConfigError, match=r"^options text has"):
        to_json("a" * MAX_TEXT_LENGTH)
    longest = "a" * (MAX_TEXT_LENGTH - 2)  # in quotes
    assert from_json(to_json(longest)) == longest


def test_an_entry_point_that_is_refused_keeps_its_own_message(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Refused while its module is imported."""
    (tmp_path / "task_of_a_user.py").write_text("import home_mjx\nhome_mjx.register('PointNav-v0', print)\n")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(errors.ConfigError, match=r"^environment id `PointNav-v0` is taken"):
        home_mjx.make(EnvSpec("Other-v0", "task_of_a_user:Task"))


def test_hints_find_names_in_other_cases():
    """`RGB` and `rgb` have no letter in common."""
    assert errors.did_you_mean("RGB", ["rgb", "depth"]).startswith("Did you mean `rgb`?")
    assert errors.did_you_mean("SEED", ["seed", "preset"]).startswith("Did you mean `seed`?")
    assert errors.did_you_mean("wood", ["Wood", "wood_8"]).startswith("Did you mean `Wood`?")


def test_hints_name_no_empty_names():
    assert errors.did_you_mean("depth", []) == errors.did_you_mean("", [""]) == "No choices are available."
    assert errors.did_you_mean("a", ["", "b"]) == "Known: b"
