"""A GPU's queue of work on the CPU: kernels compiled as C++, blocks one after the other, a team's threads in step."""

import ctypes
from pathlib import Path

from compiled_kernels import shared_library

from home_mjx.audio_jax.late_reverb.cuda.kernels import SOURCES
from home_mjx.core.native.cuda_driver import CudaStream

TEAM = 4  # threads of a block that wait for each other
TEAMS = ("resample_flights", "solve_renewal", "sum_decays")
CELLS = 2  # of a block of solve_renewal
PRELUDE = f"""
#include <pthread.h>
#include <thread>
#include "{Path(__file__).with_name("cuda_shim.h")}"
#include "{Path(__file__).with_name("driver_shim.h")}"
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
FIND = """
static Kernel kernels[] = {{{}}};
static Kernel* find_kernel(const char* name) {{
  for (auto& kernel : kernels)
    if (!strcmp(kernel.name, name)) return &kernel;
  return nullptr;
}}
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
    threads = dict.fromkeys(TEAMS, 0) | {"solve_renewal": 1024 * CELLS // 32}
    table = "".join(f'{{"{name}", run_{name}, {threads.get(name, 1)}}},' for name in KERNELS)
    calls = ((TOGETHER if name in TEAMS else SINGLE).format(name, kind) for name, kind in KERNELS.items())
    return shared_library(
        folder,
        "#include <vector>\n" + PRELUDE + text + "".join(calls) + FIND.format(table),
        "-ffp-contract=off",
        "-pthread",
        *options,
    )


class EmulatedStream(CudaStream):
    """A queue of work for these kernels, by the calls that a driver would get."""

    def __init__(self, library: ctypes.CDLL) -> None:
        self._driver, self._context, self._module = library, ctypes.c_void_p(16), ctypes.c_void_p(32)
        self._stream, self._functions = ctypes.c_void_p(48), {}

    def launch(self, name, blocks, threads, words, shared=0, rows=1) -> None:
        assert 8 * len(words) == getattr(self._driver, f"size_{name}")(), name
        super().launch(name, blocks, threads, words, shared, rows)
