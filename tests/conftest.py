"""Settings of every test: two CPU devices, a compile cache, and where the real SUNCG sample is, if it is."""

import contextlib
import ctypes
import gc
import os
import sys
import tempfile
from importlib.metadata import version
from pathlib import Path

import hypothesis
import numpy as np
import pytest
import quick_checks

ROOT = Path(__file__).resolve().parent.parent
# [bytes], of a worker between two modules; within one it may grow to 4e9. What is dropped is traced and loaded again.
MAX_MEMORY = 3.2e9
# [bytes], by which it grows before programs are dropped again: what is not theirs stays, and dropping takes seconds.
LEAST_GROWTH = 0.6e9

# In the environment, which JAX reads when it is first imported, so that processes started by tests have the same.
os.environ.setdefault("JAX_PLATFORMS", "cpu")
os.environ.setdefault("JAX_NUM_CPU_DEVICES", "2")
# Most time goes into compiling programs that run for milliseconds. XLA_FLAGS="" compiles them as users do (as `make
# test-slow` has it), at more than twice the time.
if os.environ["JAX_PLATFORMS"] == "cpu":
    quick = ["--xla_backend_optimization_level=0"]
    if tuple(map(int, version("jaxlib").split(".")[:2])) < (0, 11):  # later ones end the process at this flag
        quick.append("--xla_cpu_use_fusion_emitters=false")
    os.environ.setdefault("XLA_FLAGS", " ".join(quick))
# Taken out of the environment, where it would change what `make` does without `houses`.
SUNCG_DATA_DIR = os.environ.pop("SUNCG_DATA_DIR", None)
os.environ.setdefault("MPLBACKEND", "agg")
os.environ.setdefault("HOME_MJX_CACHE", str(Path(tempfile.gettempdir()) / "home_mjx_test_cache"))
# Thousands of the programs are single operations: to load one takes half of the time that compiling it takes.
os.environ.setdefault("JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS", "0")

# The processes that tests start, and the next run, need not compile every module anew.
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.dont_write_bytecode = False

_most_memory = MAX_MEMORY

quick_checks.install()

# Tracing makes millions of objects that stay: looking for garbage among them takes a tenth of the time.
gc.set_threshold(50_000, 20, 100)

# Deterministic: the same examples in every run. No deadline, since the first example pays for compilation.
hypothesis.settings.register_profile("home_mjx", derandomize=True, deadline=None, database=None)
hypothesis.settings.load_profile("home_mjx")


@pytest.hookimpl(trylast=True)
def pytest_configure() -> None:
    """One compile cache for all workers of pytest-xdist and all runs.

    Last, since what is imported before jaxtyping's own hook is not checked.
    """
    from home_mjx.core.compile_cache import use_compile_cache

    use_compile_cache()


def pytest_runtest_setup(item: pytest.Item) -> None:
    """Skip tests marked `cpu` where a GPU is the default device."""
    if item.get_closest_marker("cpu"):
        import jax

        if jax.default_backend() != "cpu":
            pytest.skip("about what only a CPU does: JAX_PLATFORMS=cpu")


@pytest.fixture(scope="session")
def suncg_root() -> Path:
    """Root of the real SUNCG sample (`SUNCG_DATA_DIR`, or shared/data beside the checkout); skips where absent."""
    root = Path(SUNCG_DATA_DIR or ROOT.parent / "shared" / "data" / "suncg_sample")
    if not (root / "house").is_dir():
        pytest.skip("the real SUNCG sample is not here: set SUNCG_DATA_DIR to run this test")
    return root


@pytest.fixture(autouse=True, scope="module")
def _limited_memory():
    """Drop compiled programs between modules once they fill `MAX_MEMORY`; the next ones load theirs from disk."""
    global _most_memory
    yield
    if _resident_bytes() > _most_memory:
        import jax

        jax.clear_caches()
        gc.collect()
        with contextlib.suppress(OSError, AttributeError):
            ctypes.CDLL(None).malloc_trim(0)  # glibc keeps freed memory otherwise
        _most_memory = max(MAX_MEMORY, _resident_bytes() + LEAST_GROWTH)


def _resident_bytes() -> int:
    """Return the memory of this process, 0 where the system does not say."""
    try:
        pages = int(Path("/proc/self/statm").read_text().split()[1])
    except OSError:
        return 0
    return pages * os.sysconf("SC_PAGE_SIZE")


@pytest.fixture
def rng() -> np.random.Generator:
    """A seeded generator."""
    return np.random.default_rng(0)


@pytest.fixture(scope="session")
def generated_bank(tmp_path_factory: pytest.TempPathFactory):
    """A bank of two generated houses."""
    return _generated(tmp_path_factory, range(2))


@pytest.fixture(scope="session")
def articulated_bank(tmp_path_factory: pytest.TempPathFactory):
    """The same houses with furniture that opens."""
    return _generated(tmp_path_factory, range(2), max_fronts=24)


@pytest.fixture(scope="session")
def other_bank(tmp_path_factory: pytest.TempPathFactory):
    """Another bank of the same capacities: the houses in the other order."""
    return _generated(tmp_path_factory, range(1, -1, -1))


def _generated(tmp_path_factory: pytest.TempPathFactory, seeds: range, max_fronts: int = 0):
    from generated import generate_flats

    from home_mjx.audio_jax.late_reverb.bake.field_cache import COARSE_BAKE
    from home_mjx.houses import load_bank
    from home_mjx.scene_compile.objects.fronts import ArticulationOptions
    from home_mjx.scene_compile.pipeline.compile import CompileOptions

    root, options = tmp_path_factory.mktemp("generated"), CompileOptions(articulation=ArticulationOptions(max_fronts))
    return load_bank(root, ids=generate_flats(root, seeds), bakes=(COARSE_BAKE,), options=options)
