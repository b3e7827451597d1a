"""A GPU's queue of work on the CPU: kernels compiled as C++, blocks one after the other, a team's threads in step."""

import ctypes
from pathlib import Path

import numpy as np
from compiled_kernels import shared_library

from home_mjx.audio_jax.late_reverb.cuda.kernels import SOURCES
from home_mjx.core.native.cuda_driver import CudaStream, DeviceArray

TEAM = 4  # threads of a block that wait for each other
TEAMS = ("resample_flights", "solve_renewal", "sum_decays")
CELLS = 2  # of a block of solve_renewal
PRELUDE = f"""
#include <pthread.h>
#include <thread>
#include "{Path(__file__).with_name("cuda_shim.h")}"
#define __shared__ static
static pthread_barrier_t barrier;
inline void __syncthreads() {{ pthread_barrier_wait(&barrier); }}
inline long long __float2ll_rn(float x) {{ return std::llrint(x); }}
template <class T> inline T atomicAdd(T* at, T x) {{ return __atomic_fetch_add(at, x, __ATOMIC_RELAXED); }}
"""
SINGLE = """
extern "C" void run_{0}(const void* words, int blocks, int rows) {{
  for (int y = 0; y < rows; ++y)
    for (int x = 0; x < blocks; ++x) {{
      blockIdx = {{unsigned(x), unsigned(y), 0}};
      {0}(*(const {1}*)words);
    }}
}}
extern "C" int size_{0}() {{ return sizeof({1}); }}
"""
TOGETHER = """
extern "C" void run_{0}(const void* words, int blocks, int rows) {{
  pthread_barrier_init(&barrier, nullptr, TEAM);
  for (int x = 0; x < blocks * rows; ++x) {{
    std::vector<std::thread> threads;
    for (unsigned i = 0; i < TEAM; ++i)
      threads.emplace_back([=] {{
        threadIdx = {{i, 0, 0}}, blockIdx = {{unsigned(x % blocks), unsigned(x / blocks), 0}};
        {0}(*(const {1}*)words);
      }});
    for (auto& one : threads) one.join();
  }}
  pthread_barrier_destroy(&barrier);
}}
extern "C" int size_{0}() {{ return sizeof({1}); }}
"""
KERNELS = {
    "trace_segments": "Flights",
    "resample_flights": "Flights",
    "finish_flights": "Flights",
    "test_segments": "Segments",
    "scale_sums": "Scaling",
    "gather_states": "Gathering",
    "solve_renewal": "Renewal",
    "sum_rooms_over_time": "RoomSums",
    "sum_after": "After",
    "sum_spans": "Pairs",
    "sum_decays": "Pairs",
    "sum_targets": "Pairs",
}


def emulate_kernels(folder: Path, *options: str) -> ctypes.CDLL:
    """All kernels of the baker as functions for the CPU."""
    text = "".join(source.read_text() for source in SOURCES)
    text = text.replace("constexpr int BLOCK = 64;", "constexpr int BLOCK = 1;")
    for name, size in (("TEAM", 256), ("RENEWAL_TEAM", 1024), ("DECAY_TEAM", 128)):
        text = text.replace(f"constexpr int {name} = {size};", f"constexpr int {name} = {TEAM};")
    text = text.replace("constexpr int CELLS = 32;", f"constexpr int CELLS = {CELLS};")
    text = text.replace("extern __shared__ double moved[];", "static double moved[4096];")
    text = text.replace("extern __shared__ Sum room[];", "static Sum room[4096];")
    calls = ((TOGETHER if name in TEAMS else SINGLE).format(name, kind) for name, kind in KERNELS.items())
    return shared_library(
        folder, "#include <vector>\n" + PRELUDE + text + "".join(calls), "-ffp-contract=off", "-pthread", *options
    )


class EmulatedStream(CudaStream):
    """What stands for `CudaStream`; every array lies in an allocation of its own."""

    def __init__(self, library: ctypes.CDLL) -> None:
        self.library, self.held = library, {}

    def allocate(self, nbytes: int) -> int:
        memory = np.full(nbytes, 0xA5, np.uint8)
        self.held[memory.ctypes.data] = memory
        return memory.ctypes.data

    def release(self, address: int) -> None:
        self.held.pop(address)[:] = 0xA5

    def zeros(self, shape, dtype) -> DeviceArray:
        return self.upload(np.zeros(shape, dtype))

    def upload(self, values) -> DeviceArray:
        array = DeviceArray(self, values.shape, values.dtype)
        self.held[array.address][: values.nbytes] = np.frombuffer(np.ascontiguousarray(values).tobytes(), np.uint8)
        return array

    def download(self, array, count=None) -> np.ndarray:
        values = self.held[array.address].view()[: array.nbytes]
        values = (
            values[: int(np.prod(array.shape)) * array.dtype.itemsize].copy().view(array.dtype).reshape(array.shape)
        )
        return values if count is None else values[:count]

    def synchronize(self) -> None:
        pass

    def launch(self, name, blocks, threads, words, shared=0, rows=1) -> None:
        assert 8 * len(words) == getattr(self.library, f"size_{name}")(), name
        given = np.ascontiguousarray(words, np.int64)
        each = 32 // CELLS if name == "solve_renewal" else 1 if name in TEAMS else threads
        getattr(self.library, f"run_{name}")(ctypes.c_void_p(given.ctypes.data), blocks * each, rows)
