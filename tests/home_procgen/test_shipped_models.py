"""Shipped models: those of the recipes, to the last bit; damaged files are refused."""

import os
import subprocess
import sys

import numpy as np
import pytest

from home_mjx.errors import DatasetError
from home_procgen import model_store
from home_procgen.build_library import RECIPES, hash_recipes, write_models
from home_procgen.model_store import STORE, ModelStore, family_numbers, library, library_model
from home_procgen.primitives.detail import DETAILS
from home_procgen.primitives.solids import box, make_solid, rotate
from home_procgen.things import build_models, families

SAMPLED = ("plant", "double_bed", "door", "dresser", "table_lamp")  # leaves, cloth, two states, joints, lights


def check_equal(one, other):
    assert (one.id, one.family, one.fine, one.lights) == (other.id, other.family, other.fine, other.lights)
    assert dict(one.slots) == dict(other.slots)
    assert one.joints == other.joints
    np.testing.assert_array_equal(one.parts, other.parts, err_msg=one.id)
    for a, b in zip(one.meshes, other.meshes, strict=True):
        if a is None or b is None:
            assert a is b
            continue
        assert (a.path, a.materials, a.groups) == (b.path, b.materials, b.groups)
        for name in ("vertices", "faces", "uv", "slot", "group", "normal"):
            np.testing.assert_array_equal(getattr(a, name), getattr(b, name), err_msg=f"{one.id} {name}")


def test_shipped_models_are_of_the_recipes_as_they_are():
    assert RECIPES.read_text().strip() == hash_recipes(), "run `python -m home_procgen.build_library`"
    assert [family_numbers(name) for name in families()] == [family.numbers for family in families().values()]


@pytest.mark.parametrize("detail", DETAILS)
@pytest.mark.parametrize("family", SAMPLED)
def test_recipes_build_the_shipped_models(family, detail):
    for number in (1, 2):
        check_equal(families()[family].model(number, detail), library_model(f"home_{family}_{number}", detail))


@pytest.mark.slow
@pytest.mark.parametrize("detail", DETAILS)
def test_recipes_build_all_shipped_models(detail):
    built = build_models(detail)
    assert list(built) == list(library(detail))
    for key, model in built.items():
        check_equal(model, library(detail)[key])


@pytest.mark.slow
def test_the_command_writes_the_shipped_file(tmp_path):
    write_models(tmp_path / STORE.name, {detail: build_models(detail) for detail in DETAILS})
    assert (tmp_path / STORE.name).read_bytes() == STORE.read_bytes()


BUILD = """
import sys
from pathlib import Path
import jaxtyping
jaxtyping.config.update("jaxtyping_disable", True)
from home_procgen.build_library import write_models
from home_procgen.primitives.detail import DETAILS
from home_procgen.things import build_models
write_models(Path(sys.argv[1]), {detail: build_models(detail) for detail in DETAILS})
"""


def used_features(*left_out: str) -> str:
    """Return the instruction sets that NumPy uses here beyond its baseline, without some of them."""
    core = np._core._multiarray_umath
    return " ".join(name for name in core.__cpu_dispatch__ if core.__cpu_features__.get(name) and name not in left_out)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("disabled", "blas"), [(used_features(), "Nehalem"), (used_features("X86_V3", "AVX2", "FMA3"), "Haswell")]
)
def test_other_processors_build_the_shipped_file(tmp_path, disabled, blas):
    """Sines, powers and products of matrices differ there in the last bit; other makes than x86 ignore the names."""
    changed = {"NPY_DISABLE_CPU_FEATURES": disabled, "OPENBLAS_CORETYPE": blas}
    subprocess.run([sys.executable, "-c", BUILD, tmp_path / STORE.name], env={**os.environ, **changed}, check=True)
    assert (tmp_path / STORE.name).read_bytes() == STORE.read_bytes()


@pytest.mark.parametrize("angle", [0.0, np.pi / 4, np.pi / 2])
def test_last_bits_of_vertices_change_no_solid(angle):
    """The extents of a cube are equal; turned by 45 degrees, so are components of its normals."""
    solid = rotate(box("wood", (0.3, 0.3, 0.3), (0.7, 0.1, 0.2)), 1, angle)
    right = make_solid("wood", solid.vertices, solid.faces)
    for seed in range(5):
        noise = np.random.default_rng(seed).uniform(-1e-15, 1e-15, solid.vertices.shape)
        found = make_solid("wood", solid.vertices + noise, solid.faces)
        np.testing.assert_array_equal(found.vertices, right.vertices)
        np.testing.assert_array_equal(found.uv, right.uv)


@pytest.mark.parametrize("damage", ["byte", "end", "empty", "missing"])
def test_damaged_files_are_refused(tmp_path, damage):
    path, data = tmp_path / STORE.name, bytearray(STORE.read_bytes())
    data[len(data) // 2] ^= 255
    if damage != "missing":
        path.write_bytes({"byte": data, "end": STORE.read_bytes()[:-1000], "empty": b""}[damage])
    with pytest.raises(DatasetError, match="library of furniture is") as caught:
        ModelStore(path)
    assert "python -m home_procgen.build_library" in caught.value.hint
    assert str(path) in str(caught.value)


def test_models_and_families_that_are_not_shipped_are_refused():
    for find, name in ((library_model, "home_sofa_999"), (family_numbers, "spaceship")):
        with pytest.raises(DatasetError, match=f"has no .* `{name}`"):
            find(name)


def test_the_file_is_read_once(monkeypatch):
    monkeypatch.setattr(model_store, "read_entry", None)
    assert library_model("home_sofa_2") is library_model("home_sofa_2")
