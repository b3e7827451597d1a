"""Settings of every test: two CPU devices, a compile cache, and where the real SUNCG sample is, if it is."""

import os
import tempfile
from pathlib import Path

os.environ.setdefault("JAX_PLATFORMS", "cpu")

import jax
import numpy as np
import pytest

ROOT = Path(__file__).resolve().parent.parent
jax.config.update("jax_num_cpu_devices", 2)
jax.config.update(
    "jax_compilation_cache_dir",
    os.environ.get("HOME_MJX_TEST_CACHE", str(Path(tempfile.gettempdir()) / "home_mjx_jax_cache")),
)
jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.5)


@pytest.fixture(scope="session")
def suncg_root() -> Path:
    """Root of the real SUNCG sample (`SUNCG_DATA_DIR`, or shared/data beside the checkout); skips where absent."""
    root = Path(os.environ.get("SUNCG_DATA_DIR") or ROOT.parent / "shared" / "data" / "suncg_sample")
    if not (root / "house").is_dir():
        pytest.skip("the real SUNCG sample is not here: set SUNCG_DATA_DIR to run this test")
    return root


@pytest.fixture
def rng() -> np.random.Generator:
    """A seeded generator."""
    return np.random.default_rng(0)
