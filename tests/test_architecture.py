"""The package's structure: folders follow the flow of data (docs/architecture.md), and nothing imports backwards."""

import ast
import importlib
import subprocess
import sys
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "home_mjx"
MOST_FILES = 10  # in a folder, besides its `__init__`
# From below: a part imports only from rows before its own, and from its own package. Parts of one row do not import
# each other, unless they stand in the order of a pair below.
ROWS = (
    ("errors", "moved"),
    ("core",),
    ("schema",),
    ("datasets",),
    ("scene_compile",),
    ("bank",),
    ("navigation", "physics", "raycast_render"),
    ("arrangements", "audio_jax"),
    ("tasks",),
    ("registry",),
    ("adapters", "training", "viz"),
    ("bench", "play", "trajectories"),
    ("demo",),
    ("cli", "__init__"),
    ("__main__",),
)
WITHOUT_JAX = ("schema", "datasets", "scene_compile")

Module = tuple[str, ...]  # ("bank", "packing", "pack"); a package ends in "__init__"


def modules() -> dict[Module, ast.Module]:
    paths = sorted(PACKAGE.rglob("*.py"))
    return {path.relative_to(PACKAGE).with_suffix("").parts: ast.parse(path.read_text()) for path in paths}


MODULES = modules()


def imported(module: Module, tree: ast.Module) -> Iterator[Module]:
    """Modules of the package that one imports, wherever in its code."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                if alias.name.split(".")[0] == "home_mjx":
                    yield module_of(tuple(alias.name.split("."))[1:])
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{module}: relative import"
            if (node.module or "").split(".")[0] == "home_mjx":
                base = tuple(node.module.split("."))[1:]
                yield from (module_of((*base, alias.name)) for alias in node.names)


def module_of(name: Module) -> Module:
    """The module that a dotted name stands for: itself, a package, or what it is defined in."""
    for candidate in (name, (*name, "__init__"), name[:-1], (*name[:-1], "__init__")):
        if candidate in MODULES:
            return candidate
    raise AssertionError(f"home_mjx.{'.'.join(name)} does not exist")


IMPORTS = {module: set(imported(module, tree)) - {module} for module, tree in MODULES.items()}


def is_facade(module: Module) -> bool:
    """An `__init__` that only hands names on: it is no part of the flow inside its own package."""
    return module[-1] == "__init__" and len(module) > 1


def row_of(part: str) -> int:
    found = [number for number, row in enumerate(ROWS) if part in row]
    assert len(found) == 1, f"home_mjx/{part} has no row in ROWS: say where in the flow of data it belongs"
    return found[0]


def rings(arrows: Mapping[Module, Iterable[Module]]) -> list[list[Module]]:
    """Nodes that reach themselves, by peeling off what no node leads to or from."""
    left = {a: set(b) - {a} for a, b in arrows.items()}
    while True:
        ends = {a for a, b in left.items() if not b & left.keys()}
        if not ends:
            return [sorted(left)] if left else []
        left = {a: b - ends for a, b in left.items() if a not in ends}


def folder_arrows(deep: bool) -> dict[Module, set[Module]]:
    """Which folders import which; `deep`: folders at any depth, otherwise top-level parts."""
    arrows: dict[Module, set[Module]] = defaultdict(set)
    for module, targets in IMPORTS.items():
        if is_facade(module) and deep:
            continue
        for target in targets:
            if target == ("__init__",):
                continue  # see the test of the top level
            a, b = (m[:-1] or m[:1] for m in (module, target)) if deep else (module[:1], target[:1])
            if is_facade(target) and deep and b == a[: len(b)]:
                continue  # its own facade, see the test of that
            arrows[a].add(b)
            arrows.setdefault(b, set())
    return {a: b - {a} for a, b in arrows.items()}


def test_imports_follow_the_flow_of_data():
    back = [
        f"home_mjx.{'.'.join(a)} imports home_mjx.{'.'.join(b)}"
        for a, targets in IMPORTS.items()
        for b in targets
        if a[0] != b[0] and b != ("__init__",) and row_of(b[0]) >= row_of(a[0])
    ]
    assert back == []


def test_only_the_command_line_and_versions_read_the_top_level():
    """`home_mjx/__init__` sits above everything; below it only its version may be asked for."""
    allowed = {("cli", "__init__"), ("bench", "record"), ("bench", "timing")}
    users = {a for a, targets in IMPORTS.items() if ("__init__",) in targets}
    assert users <= allowed


@pytest.mark.parametrize("deep", [False, True], ids=["parts", "folders"])
def test_no_ring_of_folders(deep: bool):
    assert rings(folder_arrows(deep)) == []


def test_no_ring_of_files():
    """Facades apart: they hand on what lies below them."""
    arrows = {a: {b for b in targets if not is_facade(b)} for a, targets in IMPORTS.items()}
    assert rings(arrows) == []


def test_rings_are_found():
    a, b, c, d = (("a",), ("b",), ("c",), ("d",))
    assert rings({a: [b], b: [c], c: [a], d: []}) == [[a, b, c]]
    assert rings({a: [b], b: [c], c: [], d: [a]}) == []


def test_no_package_imports_its_own_facade():
    wrong = [
        f"home_mjx.{'.'.join(a)} imports its own home_mjx.{'.'.join(b[:-1])}"
        for a, targets in IMPORTS.items()
        for b in targets
        if is_facade(b) and a[: len(b) - 1] == b[:-1] and exports(b) and a[-1] not in ("__init__", "__main__")
    ]
    assert wrong == []


def exports(facade: Module) -> list[str]:
    return list(getattr(importlib.import_module(".".join(("home_mjx", *facade[:-1]))), "__all__", ()))


def test_no_folder_is_too_full():
    counts: dict[str, int] = defaultdict(int)
    for module in MODULES:
        if module[-1] not in ("__init__", "__main__"):
            counts["/".join(module[:-1])] += 1
    assert {folder: count for folder, count in counts.items() if count > MOST_FILES} == {}


def test_every_folder_is_a_package_that_says_what_it_is():
    folders = {(*module[:-1], "__init__") for module in MODULES}
    assert [f for f in folders if f not in MODULES or not ast.get_docstring(MODULES[f])] == []


@pytest.mark.parametrize("part", WITHOUT_JAX)
def test_host_packages_load_no_jax(part: str):
    """Every module of them, in a process of its own."""
    program = f"""
import importlib, pkgutil, sys
import home_mjx.{part} as package
for module in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
    importlib.import_module(module.name)
assert not {{"jax", "jaxlib"}} & set(sys.modules), "JAX was loaded"
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr


def packages() -> list[str]:
    return sorted(".".join(("home_mjx", *module[:-1])) for module in MODULES if is_facade(module))


@pytest.mark.parametrize("name", packages())
def test_no_public_name_is_that_of_a_module_beside_it(name: str):
    """`package.name` would be the function or the module, by the order of imports."""
    package = importlib.import_module(name)
    beside = {path.stem for path in Path(package.__path__[0]).iterdir()} - {"__init__"}
    assert set(getattr(package, "__all__", ())) & beside == set()


def test_compiled_houses_are_made_anew_when_their_compiler_changes():
    """The cache's version covers every module that making an entry runs, and nothing of the rest."""
    from home_mjx.houses.version import compiler_files

    plain = {("errors",), ("core", "checks"), ("core", "paths")}  # messages and places: they make no array
    wanted, left = set(), [("scene_compile", "pipeline", "compile"), ("datasets", "suncg", "dataset")]
    while left:
        module = left.pop()
        if module not in wanted:
            wanted.add(module)
            left += [m for m in IMPORTS[module] if m[-1] != "__init__"]
    covered = {path.relative_to(PACKAGE).with_suffix("").parts for path in compiler_files() if path.suffix == ".py"}
    assert wanted - plain <= covered
    assert not {m for m in covered if m[0] in ("bank", "tasks", "raycast_render") or m[:2] == ("scene_compile", "mjcf")}
    assert {path.name for path in compiler_files()} >= {"acoustic_absorption.csv", "color_names.csv", "categories.json"}
