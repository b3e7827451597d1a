"""The package's structure: folders follow the flow of data (docs/architecture.md), and nothing imports backwards."""

import ast
import functools
import importlib
import subprocess
import sys
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("home_mjx", "home_procgen")
MAX_FILES = 15  # in a folder, besides its `__init__`
MIN_FILES = 3
FEW_FILES: Mapping[str, str] = {  # folders with fewer files, each with its reason
    "home_mjx/scene_compile/lighting": "a stage of the compiler; indirect light joins it",
    "home_mjx/tasks/scripted_agents": "tasks that use expert policies, which themselves use the suite",
}
MAX_SHORT_MODULES = 30
SHORT = 50  # [lines]
MAX_EXPORTS = 40  # names of a facade
# From below: a part imports only from rows before its own, and from its own package.
ROWS = (
    ("errors",),
    ("hosts",),
    ("sharding",),
    ("core",),
    ("schema",),
    ("geometry",),
    ("bank", "datasets"),
    ("navigation", "raycast_render", "scene_compile"),
    ("audio_jax", "houses", "light_probes", "physics"),
    ("tasks",),
    ("registry",),
    ("env_factory",),
    ("adapters",),
    ("training",),
    ("viewer",),
    ("cli", "__init__"),
)
WITHOUT_JAX = ("schema", "geometry", "datasets", "scene_compile")
# Lines of this distribution that an import loads, at most: engines stand alone, without datasets and generators.
CLOSURES = {
    "home_mjx": 1_500,
    "home_mjx.bank": 6_000,
    "home_mjx.raycast_render": 12_400,
    "home_mjx.physics": 16_000,
    "home_mjx.audio_jax": 22_800,
    "home_mjx.tasks": 46_400,
}
NOT_BELOW = {  # packages that an import must not load
    "home_mjx.bank": ("home_mjx.datasets", "home_mjx.scene_compile", "home_procgen"),
    "home_mjx.raycast_render": ("home_mjx.datasets", "home_mjx.scene_compile", "home_procgen"),
    "home_mjx.navigation": ("home_mjx.datasets", "home_procgen"),
    "home_mjx.physics": ("home_mjx.datasets", "home_mjx.scene_compile", "home_procgen"),
    "home_mjx.audio_jax": ("home_mjx.datasets", "home_mjx.scene_compile", "home_procgen"),
    "home_mjx.tasks": (
        *("home_mjx.datasets", "home_mjx.scene_compile", "home_procgen"),
        *("imageio_ffmpeg", "matplotlib", "flax", "brax"),
    ),
}
# Imports inside functions hide weight or a ring; each place has its reason.
LAZY: Mapping[str, str] = {
    "home_mjx.audio_jax.geometry.nearest_boxes": "Numba kernels compile on first use",
    "home_mjx.audio_jax.kernels.cpu.xla_calls": "Numba kernels compile on first use",
    "home_mjx.audio_jax.late_reverb.lookup.coupled_decay": "Numba kernels compile on first use",
    "home_mjx.audio_jax.late_reverb.bake.field_cache": "Numba is loaded where a house is baked",
    "home_mjx.bank.bank": "HTML is formatted in notebooks alone",
    "home_mjx.cli": "a command loads only its own part, so that --help is quick",
    "home_mjx.light_probes.bake": "Numba is loaded where a house is baked",
    "home_mjx.core.native.kernel": "Numba and nvcc are loaded when a kernel is built",
    "home_mjx.env_factory": "`import home_mjx` loads no engine",
    "home_mjx.geometry.meshes": "Numba is loaded where trees are built",
    "home_mjx.physics.fused": "kernels of a device are loaded for that device",
    "home_mjx.physics.kinematic.native": "kernels of a device are loaded for that device",
    "home_mjx.navigation.distance_fields": "kernels of a device are loaded for that device",
    "home_mjx.raycast_render.backends.cpu": "Numba kernels compile on first use",
    "home_mjx.raycast_render.light_kernel.surface_light": "Numba kernels compile on first use",
    "home_mjx.registry": "a filter of houses is checked where one is given",
    "home_mjx.viewer.demo.search": "policies need Flax, which is loaded with a checkpoint",
    "home_mjx.viewer.episodes": "policies need Flax, which is loaded with a checkpoint",
    "home_procgen.plugin": "an entry point loads the generator on first use",
    "home_procgen.shipped": "models and textures are loaded where they are made",
    "home_procgen.things.seats.armchairs": "two kinds of seats share parts",
}

Module = tuple[str, ...]  # ("home_mjx", "bank", "packing", "pack"); a package ends in "__init__"


def modules() -> dict[Module, ast.Module]:
    paths = sorted(path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))
    return {path.relative_to(ROOT).with_suffix("").parts: ast.parse(path.read_text()) for path in paths}


MODULES = modules()


def imported(module: Module, tree: ast.AST) -> Iterator[Module]:
    """Modules of the packages that one imports, wherever in its code."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                if alias.name.split(".")[0] in PACKAGES:
                    yield module_of(tuple(alias.name.split(".")))
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{module}: relative import"
            if (node.module or "").split(".")[0] in PACKAGES:
                base = tuple(node.module.split("."))
                yield from (module_of((*base, alias.name)) for alias in node.names)


def module_of(name: Module) -> Module:
    """The module of a dotted name: itself, a package, or the module that defines it."""
    for candidate in (name, (*name, "__init__"), name[:-1], (*name[:-1], "__init__")):
        if candidate in MODULES:
            return candidate
    raise AssertionError(f"{'.'.join(name)} does not exist")


IMPORTS = {module: set(imported(module, tree)) - {module} for module, tree in MODULES.items()}


def is_facade(module: Module) -> bool:
    """Whether a module is the `__init__` of a folder, which only hands names on."""
    return module[-1] == "__init__" and len(module) > 2


def part_of(module: Module) -> str:
    return module[1]


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


def folder_arrows(depth: int) -> dict[Module, set[Module]]:
    """Imports among folders, each cut to so many parts; facades and the top level apart."""
    arrows: dict[Module, set[Module]] = defaultdict(set)
    for module, targets in IMPORTS.items():
        if is_facade(module) or len(module) == 2:
            continue
        for target in targets:
            if len(target) == 2 and target[-1] == "__init__":
                continue  # see the test of the top level
            a, b = (m[:-1][:depth] or m[:1] for m in (module, target))
            if is_facade(target) and b == a[: len(b)]:
                continue  # its own facade, see the test of that
            arrows[a].add(b)
            arrows.setdefault(b, set())
    return {a: b - {a} for a, b in arrows.items()}


def test_each_row_names_parts_that_exist():
    """A folder of which only caches are left would still import."""
    files = {part_of(module) for module in IMPORTS if module[0] == "home_mjx"}
    assert {part for row in ROWS for part in row} - files == set()


def test_imports_follow_the_flow_of_data():
    back = [
        f"{'.'.join(a)} imports {'.'.join(b)}"
        for a, targets in IMPORTS.items()
        for b in targets
        if a[0] == b[0] == "home_mjx"
        and part_of(a) != part_of(b)
        and b != ("home_mjx", "__init__")
        and row_of(part_of(b)) >= row_of(part_of(a))
    ]
    assert back == []


def test_the_simulator_does_not_import_the_generator():
    """It plugs in by entry points; the command that writes houses is the one place that names it."""
    users = {a for a, targets in IMPORTS.items() if a[0] == "home_mjx" and any(b[0] == "home_procgen" for b in targets)}
    assert users <= {("home_mjx", "cli", "commands", "generate")}


def test_only_the_command_line_imports_the_top_level():
    """`home_mjx/__init__` imports the registry; the command line reads its version."""
    assert {a for a, targets in IMPORTS.items() if ("home_mjx", "__init__") in targets} <= {
        ("home_mjx", "cli", "__init__")
    }


@pytest.mark.parametrize("depth", [2, 3, 4, 5])
def test_no_ring_of_folders(depth: int):
    assert rings(folder_arrows(depth)) == []


def test_no_ring_of_files():
    assert rings({a: {b for b in targets if not is_facade(b)} for a, targets in IMPORTS.items()}) == []


def test_rings_are_found():
    a, b, c, d = (("a",), ("b",), ("c",), ("d",))
    assert rings({a: [b], b: [c], c: [a], d: []}) == [[a, b, c]]
    assert rings({a: [b], b: [c], c: [], d: [a]}) == []


def test_no_package_imports_its_own_facade():
    wrong = [
        f"{'.'.join(a)} imports its own {'.'.join(b[:-1])}"
        for a, targets in IMPORTS.items()
        for b in targets
        if is_facade(b) and a[: len(b) - 1] == b[:-1] and exports(b) and a[-1] not in ("__init__", "__main__")
    ]
    assert wrong == []


def exports(facade: Module) -> list[str]:
    return list(getattr(importlib.import_module(".".join(facade[:-1])), "__all__", ()))


def folder_sizes() -> dict[str, int]:
    counts: dict[str, int] = defaultdict(int)
    for module in MODULES:
        if module[-1] not in ("__init__", "__main__"):
            counts["/".join(module[:-1])] += 1
    return counts


def test_no_folder_is_too_full():
    assert {folder: count for folder, count in folder_sizes().items() if count > MAX_FILES} == {}


def test_no_folder_is_nearly_empty():
    inner = {"/".join(module[:-2]) for module in MODULES if is_facade(module)}
    few = {f for f, count in folder_sizes().items() if count < MIN_FILES and f not in inner and "/v1" not in f}
    assert few == set(FEW_FILES)


def test_few_modules_are_short():
    lines = {m: len((ROOT / Path(*m)).with_suffix(".py").read_text().splitlines()) for m in MODULES}
    short = [".".join(m) for m, n in lines.items() if n < SHORT and m[-1] not in ("__init__", "__main__")]
    assert len([name for name in short if name.startswith("home_mjx")]) <= MAX_SHORT_MODULES, short


def test_every_folder_is_a_package_that_says_what_it_is():
    folders = {(*module[:-1], "__init__") for module in MODULES}
    assert [f for f in folders if f not in MODULES or not ast.get_docstring(MODULES[f])] == []


def test_public_class_names_are_unique():
    """The first generator is left as it was."""
    names = Counter(
        node.name
        for module, tree in MODULES.items()
        if "v1" not in module
        for node in tree.body
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_")
    )
    assert [name for name, count in names.items() if count > 1] == []


@functools.cache
def lazy_imports() -> frozenset[str]:
    """Modules with an import inside a function, of these packages."""
    found = set()
    for module, tree in MODULES.items():
        for node in ast.walk(tree):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and any(imported(module, node)):
                found.add(".".join(module))
    return frozenset(found)


def test_imports_inside_functions_are_in_named_places():
    named = {name for name in lazy_imports() if any(name.startswith(place) for place in LAZY)}
    assert lazy_imports() - named == set()
    assert [place for place in LAZY if not any(name.startswith(place) for name in lazy_imports())] == []


@pytest.mark.parametrize("part", WITHOUT_JAX)
def test_host_packages_load_no_jax(part: str):
    """Every module of them, in a process of its own."""
    program = f"""
import importlib, pkgutil, sys
import home_mjx.{part} as package
for module in pkgutil.walk_packages(getattr(package, "__path__", ()), package.__name__ + "."):
    importlib.import_module(module.name)
assert not {{"jax", "jaxlib"}} & set(sys.modules), "JAX was loaded"
"""
    run_python(program)


def test_compiling_houses_loads_no_jax():
    """Worker processes that compile houses start quickly."""
    run_python("import sys, home_mjx.houses; assert not {'jax', 'jaxlib'} & set(sys.modules), 'JAX was loaded'")


@pytest.mark.parametrize("name", CLOSURES)
def test_an_engine_loads_few_lines_and_nothing_above_it(name: str):
    program = f"""
import sys
import {name}
packages = {PACKAGES!r}
found = [m for n, m in list(sys.modules.items()) if n.split(".")[0] in packages]
files = [m.__file__ for m in found if getattr(m, "__file__", None)]
lines = sum(len(open(f).readlines()) for f in files if f.endswith(".py"))
print(lines, *sys.modules)
"""
    lines, *loaded = run_python(program).split()
    assert int(lines) <= CLOSURES[name]
    above = [m for m in loaded for p in NOT_BELOW.get(name, ()) if m == p or m.startswith(p + ".")]
    assert above == []


def run_python(program: str) -> str:
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    return done.stdout


def packages() -> list[str]:
    return sorted(".".join(module[:-1]) for module in MODULES if module[-1] == "__init__")


@pytest.mark.parametrize("name", packages())
def test_a_facade_is_small_and_none_of_its_names_is_that_of_a_module_beside_it(name: str):
    """`package.name` would be the function or the module, by the order of imports."""
    package = importlib.import_module(name)
    beside = {path.stem for path in Path(package.__path__[0]).iterdir()} - {"__init__"}
    public = set(getattr(package, "__all__", ()))
    assert public & beside == set()
    assert len(public) <= MAX_EXPORTS


def test_compiled_houses_are_made_anew_when_their_compiler_changes():
    """The cache's version covers every module that making an entry runs, and nothing of the rest."""
    from home_mjx.houses.version import compiler_files

    plain = {
        ("home_mjx", "errors"),
        ("home_mjx", "core", "checks"),
        ("home_mjx", "core", "paths"),
    }  # they make no array
    first = [("home_mjx", "scene_compile", "pipeline", "compile"), ("home_mjx", "datasets", "suncg", "dataset")]
    wanted, left = set(), first
    while left:
        module = left.pop()
        if module not in wanted:
            wanted.add(module)
            left += [m for m in IMPORTS[module] if m[-1] != "__init__"]
    covered = {path.relative_to(ROOT).with_suffix("").parts for path in compiler_files()}
    assert wanted - plain <= covered
    assert not {
        m for m in covered if m[1] in ("bank", "tasks", "raycast_render") or m[1:3] == ("scene_compile", "mjcf")
    }
    assert {path.name for path in compiler_files()} >= {"acoustic_absorption.csv", "color_names.csv", "categories.json"}
