"""The kernel of rooms without a GPU: compiled as C++ for the CPU it gives what the matrix exponential does."""

import ctypes
import functools
import itertools
import shutil
import subprocess
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.linalg import expm

from home_mjx.audio_jax.baked import rooms
from home_mjx.core.native import nvrtc
from home_mjx.errors import ExecutorError

SHIM = Path(__file__).parents[2] / "helpers" / "block_shim.h"
PROGRAM = """
#define SIZE {size}
#include "{shim}"
static void** p;
{source}
static void go() {{ fall_in_rooms((float*)p[0], (float*)p[1], (float*)p[2], (int*)p[3], (float*)p[4]); }}
extern "C" void run(void** operands, int x, int y, int threads, int words) {{
  p = operands;
  run_block(x, y, threads, words, go);
}}
"""


@pytest.fixture
def here(tmp_path, monkeypatch):
    """Calls of XLA run the kernel on the CPU."""
    compiler = shutil.which("c++") or shutil.which("g++")
    if not compiler:
        pytest.skip("there is no C++ compiler here")

    def ffi_call(target, results):
        def call(*operands, **sizes):
            source = rooms.SOURCE.read_text().replace("extern __shared__ float shared[];", "")
            main, built = tmp_path / "rooms.cpp", tmp_path / "rooms.so"
            main.write_text(PROGRAM.format(size=operands[1].shape[1], shim=SHIM, source=source))
            subprocess.run([compiler, "-std=c++17", "-O1", "-shared", "-fPIC", "-w", "-o", built, main], check=True)
            given, result = [np.ascontiguousarray(x) for x in operands], np.full(results[0].shape, np.nan, np.float32)
            pointers = [x.ctypes.data for x in (*given, result)]
            words, threads = int(sizes["shared_mem_bytes"]) // 4, int(sizes["block_x"])
            run = ctypes.CDLL(str(built)).run
            for x, y in itertools.product(range(int(sizes["grid_x"])), range(int(sizes["grid_y"]))):
                run((ctypes.c_void_p * len(pointers))(*pointers), x, y, threads, words)
            return (jnp.asarray(result),)

        return call

    monkeypatch.setattr(rooms, "ptx_of", lambda size: "")
    monkeypatch.setattr(jax.ffi, "ffi_call", ffi_call)


@pytest.mark.parametrize(
    ("size", "matrices", "bins"), [(1, 3, 40), (5, 9, 125), (8, 21, 125), (17, 7, 33), (32, 2, 64)]
)
def test_energy_falls_as_by_the_matrix_exponential(here, rng, size, matrices, bins):
    """In one room and in as many as a warp has threads, more matrices than a block has warps, any number of bins."""
    exchange = rng.uniform(0, 0.2, (2, matrices, size, size)) * (1 - np.eye(size))
    own = exchange.sum(axis=3) + rng.uniform(0.01, 0.5, (2, matrices, size))
    rates = own[..., None] * np.eye(size) - exchange
    start, listener = rng.uniform(0, 1, (2, 2, size))
    (got,) = rooms.run_rooms(bins, *(jnp.float32(x) for x in (rates, start, listener)))
    assert got.shape == (2, matrices, bins)
    for env, matrix in np.ndindex(2, matrices):
        wanted = [listener[env] @ expm(-n * rates[env, matrix]) @ start[env] for n in range(bins)]
        np.testing.assert_allclose(got[env, matrix], wanted, rtol=2e-4, atol=1e-9)


def test_it_gives_what_xla_does(here, rng, monkeypatch):
    """In the same order of states, bins and octaves."""
    monkeypatch.setattr(rooms, "_op", lambda bins: functools.partial(rooms.run_rooms, bins))
    rates = jnp.float32(np.eye(4) * rng.uniform(0.1, 0.4, (2, 3, 7, 1, 4)))
    start, listener = (jnp.float32(rng.uniform(0, 1, (2, 4))) for _ in range(2))
    wanted = jax.vmap(lambda *one: rooms.fallen_by_xla(*one, 125))(rates, start, listener)
    got = jnp.stack([rooms._by_cuda(*one, 125) for one in zip(rates, start, listener, strict=True)])
    np.testing.assert_allclose(got, wanted, rtol=2e-4, atol=1e-9)


def test_nvrtc_compiles_it():
    """If it is here."""
    try:
        nvrtc.find_library()
    except ExecutorError:
        pytest.skip("there is no NVRTC here")
    for size in (1, 8, 32):
        assert ".entry" in nvrtc.compile_ptx(rooms.SOURCE, 90, {"SIZE": size})
