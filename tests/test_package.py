"""What holds for the package as a whole: a light import, complete wheels, pins without addresses, documented names."""

import importlib
import importlib.util
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from pathlib import Path

import jax
import jaxtyping
import pytest

import home_mjx
from home_mjx.errors import did_you_mean

ROOT = Path(__file__).resolve().parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
# Written in two halves so that this file does not find itself.
REGISTRIES = tuple(
    name + rest
    for name, rest in (
        ("py" + "pi", r"\.(?:org|python|nvidia|io)"),
        ("python" + "hosted", r"\.org"),
        ("npm" + "js", r"\.(?:org|com)"),
        ("ana" + "conda", r"\.(?:org|com)"),
        ("download.py" + "torch", r"\.org"),
        ("storage.google" + "apis", r"\.com"),
        ("index" + "-url", ""),
        ("find" + "-links", ""),
    )
)


def run_python(*args: str) -> str:
    done = subprocess.run([sys.executable, *args], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return done.stdout.strip()


def tracked_files() -> list[str]:
    if not (ROOT / ".git").exists():
        pytest.skip("not a git checkout")
    listing = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, capture_output=True, text=True, check=True).stdout
    return [name for name in listing.split("\0") if name and (ROOT / name).is_file()]


def test_import_takes_less_than_a_second():
    program = "import time; start = time.perf_counter(); import home_mjx; print(time.perf_counter() - start)"
    assert min(float(run_python("-c", program)) for _ in range(3)) < 1.0


def test_import_leaves_jax_alone_and_raises_no_warning():
    loaded = run_python("-W", "error", "-c", "import home_mjx, sys; print(*sys.modules)").split()
    assert "home_mjx" in loaded
    assert not {"jax", "jaxlib", "mujoco", "numba", "trimesh", "brax"} & set(loaded)


def test_no_module_starts_a_jax_backend():
    program = """
import importlib, pkgutil, home_mjx
from home_mjx.errors import ConfigError
optional = {"brax", "flax", "jaxmarl", "matplotlib", "mujoco_playground", "optax", "pettingzoo"}
optional |= {"pyarrow", "stable_baselines3", "tensorboardX", "torch"}
for module in pkgutil.walk_packages(home_mjx.__path__, "home_mjx."):
    if module.name == "home_mjx.adapters.jaxmarl":  # JaxMARL itself starts one
        continue
    try:
        importlib.import_module(module.name)
    except (ModuleNotFoundError, ConfigError) as error:
        missing = error if isinstance(error, ModuleNotFoundError) else error.__cause__
        assert isinstance(missing, ModuleNotFoundError) and missing.name.split(".")[0] in optional, error
import jax
from jax._src import xla_bridge
assert not xla_bridge.backends_are_initialized()
jax.devices()
assert xla_bridge.backends_are_initialized()  # the question above can be answered with yes
"""
    run_python("-c", program)


def test_tests_see_two_devices_and_share_a_compile_cache():
    assert [d.platform for d in jax.devices()] == ["cpu", "cpu"]
    assert Path(jax.config.jax_compilation_cache_dir).is_absolute()
    assert run_python("-c", "import jax; print(len(jax.devices()))") == "2"


def test_annotations_are_checked_under_pytest():
    with pytest.raises(jaxtyping.TypeCheckError):
        did_you_mean(3, ["three"])  # type: ignore


def test_package_is_typed():
    assert (Path(home_mjx.__file__).parent / "py.typed").is_file()


def test_wheel_holds_every_tracked_file_of_the_package(tmp_path: Path):
    tracked = tracked_files()
    for name in tracked:
        if name.startswith("home_mjx/") or name in ("pyproject.toml", "README.md", "LICENSE", "NOTICE"):
            (tmp_path / "source" / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / name, tmp_path / "source" / name)
    build = ["-m", "pip", "wheel", "--quiet", "--no-deps", "--no-build-isolation"]
    run_python(*build, "--wheel-dir", str(tmp_path), str(tmp_path / "source"))
    (wheel,) = tmp_path.glob("*.whl")
    inside = set(zipfile.ZipFile(wheel).namelist())
    assert {name for name in tracked if name.startswith("home_mjx/")} <= inside
    assert {name.rpartition("/")[2] for name in inside if "/licenses/" in name} == {"LICENSE", "NOTICE"}


def test_no_committed_file_names_a_package_registry():
    pattern = re.compile("|".join(REGISTRIES), re.IGNORECASE)
    assert pattern.search("https://" + "py" + "pi.org/simple")
    found = [
        f"{name}: {match.group()}"
        for name in tracked_files()
        if (match := pattern.search((ROOT / name).read_text(encoding="utf-8", errors="ignore")))
    ]
    assert not found


def normalised(requirement: str) -> str:
    return re.split(r"[<>=!~\[; ]", requirement)[0].lower().replace("_", "-")


def test_pins_are_names_and_versions_only_and_cover_the_requirements():
    lines = (ROOT / "requirements" / "constraints.txt").read_text().split("\n")
    assert lines.pop() == ""
    form = re.compile(r"[A-Za-z0-9._-]+==[A-Za-z0-9.!+]+")
    assert [line for line in lines if not form.fullmatch(line)] == []
    pinned = {normalised(line) for line in lines}
    extras = PROJECT["optional-dependencies"]
    wanted = PROJECT["dependencies"] + [
        r for name in ("data", "multiagent", "test", "train", "view", "dev") for r in extras[name]
    ]
    assert {normalised(r) for r in wanted} - {"home-mjx"} <= pinned


def test_the_lowest_jax_is_one_that_is_tested():
    """Others were declared once, with which the `cpu` backend does not work."""
    matrix = (ROOT / "scripts" / "test_matrix.sh").read_text()
    lowest = re.findall(r"^jax[0-9.]+ *\|[0-9.]+\|([0-9.]+) *\|", matrix, re.MULTILINE)[0]
    assert f"jax>={lowest}" in PROJECT["dependencies"]
    assert PROJECT["optional-dependencies"]["cuda"] == [f"jax[cuda12]>={lowest}"]


def test_the_matrix_tries_the_lowest_of_every_declared_range():
    """And the newest of all."""
    matrix = (ROOT / "scripts" / "test_matrix.sh").read_text()
    assert re.findall(r"^(lowest|newest) *\|3\.1[12]\| *\|(\w+)$", matrix, re.MULTILINE) == [
        ("lowest",) * 2,
        ("newest",) * 2,
    ]
    found = subprocess.run(
        [sys.executable, ROOT / "scripts" / "lowest_pins.py"], capture_output=True, text=True, check=True
    ).stdout.splitlines()
    bounds = [requirement.split(",")[0].replace(">=", "==") for requirement in PROJECT["dependencies"]]
    assert found[:-1] == bounds
    assert found[-1].replace("jaxlib", "jax") in bounds


def test_the_notice_names_every_file_of_data():
    packages, kinds = ("home_mjx/", "home_procgen/"), (".csv", ".json", ".npz")
    data = [name for name in tracked_files() if name.startswith(packages) and name.endswith(kinds)]
    assert len(data) >= 5
    notice = (ROOT / "NOTICE").read_text(encoding="utf-8")
    assert [name for name in data if f"\n{name}\n" not in notice] == []


def test_every_hard_dependency_is_defended_in_the_docs():
    text = (ROOT / "docs" / "dependencies.md").read_text().lower()
    assert [r for r in PROJECT["dependencies"] if f"| {normalised(r)} |" not in text] == []


def api_pages() -> str:
    return "\n".join(page.read_text() for page in sorted((ROOT / "docs" / "api").glob("*.md")))


@pytest.mark.parametrize("name", [name for name in home_mjx.__all__ if not name.startswith("__")])
def test_public_names_are_documented(name: str):
    assert (getattr(home_mjx, name).__doc__ or "").strip()
    assert f"`{name}`" in api_pages()


def test_every_package_has_an_api_page():
    pages = api_pages()
    packages = sorted(p.parent.name for p in (ROOT / "home_mjx").glob("*/__init__.py"))
    assert packages
    internal = {"cli", "demo"}  # the command line has a page of its own
    assert [p for p in packages if p not in internal and f"::: home_mjx.{p}\n" not in pages] == []


def test_changelog_knows_this_version():
    assert f"## {home_mjx.__version__}" in (ROOT / "CHANGELOG.md").read_text()


def test_public_packages_export_what_exists():
    needs = {"training": "flax", "trajectories": "pyarrow"}  # of the extras `train` and `data`
    lacking = {name for name, package in needs.items() if importlib.util.find_spec(package) is None}
    for init in sorted((ROOT / "home_mjx").glob("*/__init__.py")):
        if init.parent.name in lacking:
            continue
        module = importlib.import_module(f"home_mjx.{init.parent.name}")
        missing = [name for name in getattr(module, "__all__", ()) if not hasattr(module, name)]
        assert missing == [], module.__name__


def test_the_matrix_names_tests_that_exist():
    """It is not run with every change: a moved file would show only there."""
    suite = re.search(r"^SUITE='([^']*)'", (ROOT / "scripts" / "test_matrix.sh").read_text(), re.MULTILINE)
    assert suite is not None
    assert [name for name in suite[1].split() if not (ROOT / name).exists()] == []
