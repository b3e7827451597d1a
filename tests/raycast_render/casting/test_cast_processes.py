"""The `cpu` executor where threads and processes make trouble: pmap with large arguments, forked and spawned children.

Each case runs in a process of its own under a time limit, so that a hang is a failure and not a stuck test run.
"""

import subprocess
import sys
from pathlib import Path

HELPERS = Path(__file__).resolve().parents[2] / "helpers"
LIMIT = 150  # [s]

BEGINNING = f"""
import sys
sys.path[:0] = [{str(HELPERS)!r}, {str(HELPERS.parents[1])!r}]
import jax
jax.config.update("jax_platforms", "cpu")
jax.config.update("jax_num_cpu_devices", 2)
import jax.numpy as jnp
import numpy as np
from handmade import shoebox
from home_mjx.raycast_render import Scene, cast, make_scene
from home_mjx import HouseBank

def place(house=0):
    bank = HouseBank.from_compiled([shoebox()])
    body = bank.physics.body_pos[0], bank.physics.body_quat[0]
    agent = jnp.zeros((1, 3)), jnp.array([[1.0, 0, 0, 0]])
    return jax.jit(make_scene)(bank, jnp.int32(house), *body, *agent)
"""


def run(program):
    result = subprocess.run(
        [sys.executable, "-c", BEGINNING + program], capture_output=True, text=True, timeout=LIMIT, check=False
    )
    assert result.returncode == 0, result.stderr[-3000:]
    return result.stdout.split()


def test_pmap_over_two_devices_with_megabytes_of_arguments():
    out = run("""
scene = place()
rng = np.random.default_rng(0)
origin = jnp.asarray(rng.uniform(-1, 1, (2, 50000, 3)) + [0, 0, 1.5], jnp.float32)
direction = jnp.asarray(rng.normal(size=(2, 50000, 3)), jnp.float32)
assert origin[0].nbytes + direction[0].nbytes > 1_000_000
step = jax.pmap(lambda s, o, d: cast(s, o, d, backend="cpu").t, in_axes=(None, 0, 0))
for _ in range(5):
    t = step(scene, origin, direction)
one = jax.jit(lambda s, o, d: cast(s, o, d, backend="cpu").t)
print(all(np.array_equal(t[i], one(scene, origin[i], direction[i])) for i in range(2)), np.isfinite(t).all())
""")
    assert out == ["True", "True"]


def test_forked_child_is_refused_with_an_error():
    out = run("""
import os, warnings
warnings.simplefilter("ignore")
from home_mjx.errors import BackendError
scene = place()
origin, direction = np.zeros((5, 3), np.float32) + 1, np.ones((5, 3), np.float32)
cast(scene, jnp.asarray(origin), jnp.asarray(direction)).t.block_until_ready()
child = os.fork()
if child == 0:
    try:
        cast(scene, jnp.asarray(origin), jnp.asarray(direction))
    except BackendError as error:
        print("refused" if "spawn" in str(error) else error, flush=True)
        os._exit(7)
    os._exit(1)
print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
""")
    assert out == ["refused", "7"]


def test_an_environment_that_was_made_before_a_fork_is_refused_after_it():
    """Its program is compiled: nothing is traced in the child, where errors of others arise."""
    out = run("""
import os, warnings
warnings.simplefilter("ignore")
from home_mjx.adapters.gymnasium import GymEnv, GymVectorEnv
from home_mjx.errors import BackendError
bank = HouseBank.from_compiled([shoebox()])
options = {"houses": bank, "impl": "kinematic", "sensors": ("state",)}
for env in (GymEnv(**options), GymVectorEnv(2, **options)):
    env.reset(seed=0)
    env.step(env.action_space.sample())
    child = os.fork()
    if child == 0:
        for call in (lambda: env.step(env.action_space.sample()), lambda: env.reset(seed=1)):
            try:
                call()
            except BackendError as error:
                print("refused" if "spawn" in str(error) else error, flush=True)
        os._exit(7)
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
    env.step(env.action_space.sample())
""")
    assert out == ["refused", "refused", "7"] * 2


def test_spawned_child_casts(tmp_path):
    # Spawning imports the main module again, so it has to be a file.
    (tmp_path / "main.py").write_text(
        BEGINNING
        + """
import multiprocessing

def work(_):
    return float(cast(place(), jnp.array([0.0, 0, 1]), jnp.array([1.0, 0, 0]), backend="cpu").t)

if __name__ == "__main__":
    print(work(0))
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        print(pool.map(work, [0])[0])
"""
    )
    result = subprocess.run(
        [sys.executable, tmp_path / "main.py"], capture_output=True, text=True, timeout=LIMIT, check=False
    )
    assert result.stdout.split() == ["3.0", "3.0"], result.stderr[-3000:]


def test_a_handler_that_does_not_work_is_replaced_with_one_warning():
    out = run("""
import warnings
from home_mjx.errors import BackendError
from home_mjx.raycast_render.backends.numba import chunks
def broken():
    raise OSError("no compiler today")
chunks.compile_chunks = broken
scene, origin, direction = place(), jnp.array([0.0, 0, 1]), jnp.array([1.0, 0, 0])
with warnings.catch_warnings(record=True) as caught:
    warnings.simplefilter("always")
    print(*(float(cast(scene, origin, direction).t) for _ in range(3)))
print(sum("no compiler today" in str(w.message) for w in caught))
try:
    cast(scene, origin, direction, backend="cpu")
except BackendError as error:
    print("no compiler today" in str(error))
""")
    assert out == ["3.0", "3.0", "3.0", "1", "True"]


def test_compiled_code_is_kept_on_disk():
    program = """
from home_mjx.core.native.handler import build_handler
from home_mjx.raycast_render.backends.numba.chunks import compile_chunks
functions = compile_chunks()
print(*(compiled.cache_hits for compiled in (*functions, *build_handler("home_mjx_cast", *functions))))
"""
    run(program)
    assert run(program) == ["1"] * 4
