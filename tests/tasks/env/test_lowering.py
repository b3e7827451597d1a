"""The same program in every process: only then does JAX's compile cache hit."""

import hashlib
import os
import subprocess
import sys

import jax
import pytest

from home_mjx.core.compile_cache import use_compile_cache

LOWER = """
import functools, sys
import jax, jax.numpy as jnp
from handmade import shoebox
from home_mjx import HouseBank, EnvParams, HouseholdEnv
from home_mjx.tasks import make_config
from home_mjx.tasks.sensors import SENSORS

agents, *some = sys.argv[1:]
sensors = (*(some or SENSORS), "goal")
config = make_config(sensors=sensors, width=8, height=8, num_agents=int(agents), shader="lit", late="traced")
core, params = HouseholdEnv(config), EnvParams(HouseBank.from_compiled([shoebox()]))
keys = jnp.zeros((2, 2), jnp.uint32)
start = functools.partial(core.reset, observe=False)  # a whole reset is this and what a step ends with
begin = jax.jit(jax.vmap(start, (None, 0))).lower(params, keys)
step = jax.jit(jax.vmap(core.step, (None, 0, 0))).lower(params, begin.out_info, jnp.zeros((2, *core.action_spec.shape)))
for program in (begin, step):
    sys.stdout.write(program.as_text() + "\\n")
"""


def lowered(seed: int, agents: int, sensors: tuple[str, ...]) -> str:
    helpers = os.path.join(os.path.dirname(__file__), "..", "..", "helpers")
    path = os.pathsep.join([helpers, os.getcwd(), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [sys.executable, "-c", LOWER, str(agents), *sensors],
        capture_output=True,
        text=True,
        timeout=600,
        env={**os.environ, "PYTHONHASHSEED": str(seed), "PYTHONPATH": path},
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout


@pytest.mark.parametrize(("agents", "sensors"), [(1, ("rgb", "audio")), pytest.param(2, (), marks=pytest.mark.slow)])
def test_programs_are_the_same_whatever_the_hash_seed(agents, sensors):
    """The `lit` preset, which asks for rays in most ways; all sensors and two agents in the slow suite."""
    first, second = (lowered(seed, agents, sensors) for seed in (1, 2))
    assert len(first) > 100_000
    assert hashlib.sha256(first.encode()).hexdigest() == hashlib.sha256(second.encode()).hexdigest()


def test_the_cache_folder_is_the_users_where_chosen(monkeypatch, tmp_path):
    monkeypatch.setenv("JAX_COMPILATION_CACHE_DIR", str(tmp_path))
    assert use_compile_cache() == tmp_path
    monkeypatch.setenv("JAX_COMPILATION_CACHE_DIR", "")
    assert use_compile_cache() is None


def test_the_cache_folder_of_jaxs_configuration_is_kept(monkeypatch, tmp_path):
    monkeypatch.delenv("JAX_COMPILATION_CACHE_DIR", raising=False)
    before = jax.config.jax_compilation_cache_dir
    try:
        jax.config.update("jax_compilation_cache_dir", str(tmp_path))
        assert use_compile_cache() == tmp_path
        assert os.environ["JAX_COMPILATION_CACHE_DIR"] == str(tmp_path)  # that of children
        assert jax.config.jax_compilation_cache_dir == str(tmp_path)
    finally:
        jax.config.update("jax_compilation_cache_dir", before)


def test_a_second_process_compiles_nothing(tmp_path):
    """The command line's default: programs lie in the cache folder, and are found there."""
    program = """
import home_mjx, sys
home_mjx.use_compile_cache()
import jax
from handmade import shoebox
hits = []
jax.monitoring.register_event_listener(lambda event, **_: hits.append(event))
from home_mjx.tasks import make_config
core = home_mjx.HouseholdEnv(make_config(sensors=("depth", "goal"), width=8, height=8))
params = home_mjx.EnvParams(home_mjx.HouseBank.from_compiled([shoebox()]))
jax.block_until_ready(jax.jit(core.reset)(params, jax.random.key(0)).obs)
print(sum(e.endswith("cache_misses") for e in hits), sum(e.endswith("cache_hits") for e in hits))
"""
    helpers = os.path.join(os.path.dirname(__file__), "..", "..", "helpers")
    path = os.pathsep.join([helpers, os.getcwd(), os.environ.get("PYTHONPATH", "")])
    env = {k: v for k, v in os.environ.items() if not k.startswith(("JAX_COMPILATION", "JAX_PERSISTENT"))}
    env |= {"HOME_MJX_CACHE": str(tmp_path), "PYTHONPATH": path, "JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS": "0"}
    counts = []
    for seed in ("1", "2"):
        done = subprocess.run(
            [sys.executable, "-c", program],
            capture_output=True,
            text=True,
            timeout=600,
            env={**env, "PYTHONHASHSEED": seed},
        )
        assert done.returncode == 0, done.stderr[-2000:]
        counts.append([int(word) for word in done.stdout.split()])
    assert list(tmp_path.glob("programs-*"))
    (misses, _), (misses_again, hits) = counts
    assert misses > 0
    assert misses_again == 0
    assert hits >= misses
