"""The name of a version of the cache: it follows the compiler, and nothing else."""

import ast
import shutil
from pathlib import Path

import pytest

from home_mjx.core.files import read_code
from home_mjx.houses.version import PACKAGE_ROOT, compiler_files, version_of


@pytest.fixture(scope="module")
def package(tmp_path_factory) -> Path:
    return shutil.copytree(PACKAGE_ROOT, tmp_path_factory.mktemp("code") / "home_mjx")


def changed(package: Path, module: str, old: str = "", new: str = "A_WORD = 1\n") -> bool:
    """Whether `new` in the place of the first `old` of a file, or at its end, gives another version."""
    path, before = package / module, version_of(package)
    code = path.read_text()
    assert old in code
    path.write_text(code.replace(old, new, 1) if old else code + new)
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


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("", "# a word\n"),
        ('"""Covers', '"""A word: "covers" of # all kinds'),
        ('    """Return the sorted', '    # A word.\n\n    """Return, sorted, "the"'),
        ("    found = []\n", "\n    found = []  # a word\n\n"),
    ],
)
def test_comments_and_docstrings_leave_the_version_alone(package, old, new):
    assert not changed(package, "geometry/rectangle_cover.py", old, new)


@pytest.mark.parametrize(("old", "new"), [("1e-12", "1e-13"), ("    found = []\n", "    found = ['# a word']\n")])
def test_code_gives_a_new_version(package, old, new):
    assert changed(package, "geometry/rectangle_cover.py", old, new)


def without_docstrings(code: str) -> str:
    """The syntax tree, with empty docstrings."""
    tree = ast.parse(code)
    for node in ast.walk(tree):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef) and ast.get_docstring(
            node
        ):
            node.body[0] = ast.Expr(ast.Constant(""))
    return ast.dump(tree)


def test_digests_are_those_of_the_syntax_tree_without_docstrings():
    """Of all compiled code and all generators: no more and no less is removed."""
    files = [path for path in compiler_files() if path.suffix == ".py"]
    files += [
        *(PACKAGE_ROOT.parent / "home_procgen").rglob("*.py"),
        *(PACKAGE_ROOT / "datasets/suncg/write").rglob("*.py"),
    ]
    for path in files:
        assert ast.dump(ast.parse(read_code(path))) == without_docstrings(path.read_text()), path


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
