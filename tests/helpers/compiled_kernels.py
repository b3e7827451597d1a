"""CUDA C as functions for the CPU, so that kernels are tested where there is no GPU."""

import ctypes
import itertools
import shutil
import subprocess
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.core.native import nvrtc
from home_mjx.errors import BackendError

SHIM = Path(__file__).with_name("block_shim.h")


def shared_library(folder: Path, text: str, *options: str) -> ctypes.CDLL:
    """C++, compiled in a folder of its own; skips the test where there is no compiler."""
    compiler = shutil.which("c++") or shutil.which("g++")
    if not compiler:
        pytest.skip("there is no C++ compiler here")
    main, built = folder / "main.cpp", folder / "main.so"
    main.write_text(text)
    every = ["-std=c++17", "-O1", "-shared", "-fPIC", "-w", *options]
    subprocess.run([compiler, *every, "-o", built, main], check=True)
    return ctypes.CDLL(str(built))


def block_program(sources: Sequence[Path], defines: Mapping[str, int], name: str, arguments: str) -> str:
    """C++ of a kernel that is compiled for some numbers, with a function `run` for one block of it.

    Args:
        sources: Its files.
        defines: Numbers by the names that they have there.
        name: Of the kernel.
        arguments: C++ that takes them from the pointers `p`.
    """
    text = "".join(source.read_text() for source in sources).replace("extern __shared__ float shared[];", "")
    numbers = "".join(f"#define {key} {value}\n" for key, value in defines.items())
    return (
        f'{numbers}#include "{SHIM}"\nstatic void** given;\n{text}\n'
        f"static void go() {{ void** p = given; {name}({arguments}); }}\n"
        'extern "C" void run(void** operands, int x, int y, int threads, int words) '
        "{ given = operands; run_block(x, y, threads, words, go); }\n"
    )


def blocks_instead(compiled: Callable[[str, list[np.ndarray], int], ctypes.CDLL]) -> Callable:
    """What stands for `jax.ffi.ffi_call`: runs all blocks of a kernel, one after the other.

    Args:
        compiled: Gives the `block_program` of a kernel of that name, for its operands and a block's threads.
    """

    def ffi_call(target, results):
        def call(*operands, **sizes):
            given = [np.ascontiguousarray(x) for x in operands]
            result = np.full(results[0].shape, np.nan if results[0].dtype == np.float32 else -1, results[0].dtype)
            pointers = [x.ctypes.data for x in (*given, result)]
            words, threads = int(sizes["shared_mem_bytes"]) // 4, int(sizes["block_x"])
            kernel = compiled(sizes["name"], given, threads)
            for x, y in itertools.product(range(int(sizes["grid_x"])), range(int(sizes["grid_y"]))):
                kernel.run((ctypes.c_void_p * len(pointers))(*pointers), x, y, threads, words)
            return (jnp.asarray(result),)

        return call

    return ffi_call


def nvrtc_ptx(sources: Path | Sequence[Path], capability: int, defines: Mapping[str, int] = nvrtc.NO_DEFINES) -> str:
    """PTX by NVRTC; skips the test where it is not installed."""
    try:
        nvrtc.find_library()
    except BackendError:
        pytest.skip("NVRTC is not installed")
    return nvrtc.compile_ptx(sources, capability, defines)
