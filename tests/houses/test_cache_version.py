"""The name of a version of the cache: it follows the compiler, and nothing else."""

import shutil
from pathlib import Path

import pytest

from home_mjx.houses.version import PACKAGE_ROOT, version_of


@pytest.fixture(scope="module")
def package(tmp_path_factory) -> Path:
    return shutil.copytree(PACKAGE_ROOT, tmp_path_factory.mktemp("code") / "home_mjx")


def changed(package: Path, module: str) -> bool:
    """Whether a comment at a module's end gives another version."""
    path, before = package / module, version_of(package)
    code = path.read_text()
    path.write_text(f"{code}# a word\n")
    after = version_of(package)
    path.write_text(code)
    assert version_of(package) == before
    return after != before


@pytest.mark.parametrize(
    "module",
    [
        "scene_compile/mjcf/export.py",
        "houses/job.py",
        "houses/version.py",
        "bank/bank.py",
        "datasets/registry.py",
        "datasets/suncg/write/house.py",
        "datasets/suncg/validate/validate.py",
        "tasks/base/config.py",
        "raycast_render/casting/cast.py",
    ],
)
def test_what_makes_no_entry_leaves_the_version_alone(package, module):
    assert not changed(package, module)


@pytest.mark.parametrize(
    "module",
    [
        *("architecture/shell.py", "architecture/rooms.py", "objects/doors.py", "collision/level_colliders.py"),
        *("navigation/free_space.py", "lighting/lights.py", "materials/surface.py", "semantics/engine.py"),
        *("pipeline/levels.py", "pipeline/assemble.py", "../geometry/bvh.py", "../schema/color_names.csv"),
        *("../datasets/suncg/read/house_json.py", "../geometry/wall_prisms.py", "../schema/compiled.py"),
        "../core/array_store.py",
    ],
)
def test_a_changed_stage_gives_a_new_version(package, module):
    assert changed(package, f"scene_compile/{module}")


def test_a_new_file_of_a_stage_gives_a_new_version(package):
    before = version_of(package)
    new = package / "scene_compile" / "lighting" / "more.py"
    new.write_text('"""More."""\n')
    assert version_of(package) != before
    new.unlink()
    assert version_of(package) == before


def test_compiled_code_of_numba_leaves_the_version_alone(package):
    """Numba writes beside the code at the first call; the second process would compile all houses again."""
    before = version_of(package)
    folder = package / "geometry" / "__pycache__"
    folder.mkdir(exist_ok=True)
    (folder / "bvh.0123.sha256.json").write_text("{}")
    assert version_of(package) == before
