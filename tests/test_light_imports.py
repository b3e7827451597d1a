"""Imports load no more than they use: each program runs in a process of its own."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
ENCODERS = ("imageio_ffmpeg", "matplotlib", "pygame")  # for films, curves and windows alone


def run_python(program: str) -> str:
    paths = os.pathsep.join(map(str, (ROOT, ROOT / "tests" / "helpers")))
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONPATH": paths},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def loaded(program: str) -> set[str]:
    """Top-level names of the modules that a program has loaded at its end."""
    return set(run_python(f"{program}\nimport sys\nprint(*{{name.split('.')[0] for name in sys.modules}})").split())


@pytest.mark.parametrize(
    ("module", "unused"),
    [
        ("home_mjx", ("numpy", "jax", "gymnasium", "scipy")),
        ("home_mjx.cli", ("numpy", "jax", "gymnasium", "scipy")),
        ("home_mjx.raycast_render", ("gymnasium", "scipy", "numba", "PIL", "trimesh", "mujoco", "home_procgen")),
        ("home_mjx.tasks", ("gymnasium", "home_procgen", *ENCODERS)),
    ],
)
def test_an_import_loads_none_of_these(module: str, unused: tuple[str, ...]):
    assert not loaded(f"import {module}") & set(unused)


def test_a_step_needs_no_encoder_of_films():
    """Traced with images and sound; `imageio_ffmpeg` alone is a binary of 68 MB."""
    program = """
import jax
import home_mjx
from handmade import shoebox
bank = home_mjx.HouseBank.from_compiled([shoebox()])
env = home_mjx.make("PointNav-v0", bank, sensors=("rgb", "goal"), width=8, height=8, impl="kinematic")
state = jax.eval_shape(env.reset, jax.random.key(0))
jax.eval_shape(env.step, state, jax.ShapeDtypeStruct((env.action_size,), "float32"))
"""
    assert not loaded(program) & {*ENCODERS, "gymnasium", "home_procgen"}


@pytest.mark.parametrize("order", ["gymnasium, home_mjx", "home_mjx, gymnasium", "home_mjx, gymnasium.spaces"])
def test_gymnasium_has_our_ids_whichever_is_imported_first(order: str):
    program = f"""
import {order}
home_mjx.register("Later-v0", "home_mjx.tasks.suite:PointNav")
print(sum(name.startswith("home_mjx/") for name in gymnasium.registry) == len(home_mjx.list_envs()))
"""
    assert run_python(program).split() == ["True"]
