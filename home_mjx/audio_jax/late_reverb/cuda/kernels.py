"""Kernels of the baker for NVIDIA GPUs: compilation, test, and choice between GPU and CPU."""

from pathlib import Path

import numpy as np

from home_mjx.core.native.cuda_driver import CudaStream, pack_words
from home_mjx.core.native.kernel import Kernel, compile_sources
from home_mjx.raycast_render.backends.cuda import SOURCE as CAST_SOURCE

FOLDER = Path(__file__).parent
SOURCES = (CAST_SOURCE, FOLDER / "flight.cu", FOLDER / "sums.cu")
BLOCK = 64  # threads per block, as in cast.cu
LANES = 8  # floats per row of octaves, as in flight.cu


def open_gpu() -> CudaStream:
    """Open a queue of work with the kernels of flights, on JAX's first GPU.

    Raises:
        BackendError: There is no GPU, or the kernels do not compile or load.
    """
    return CudaStream(compile_sources(*SOURCES))


def traces_on_gpu(device: str) -> bool:
    """Return whether rays are traced on a GPU, for an option "auto", "cpu" or "gpu".

    Raises:
        BackendError: The option is "gpu", and no GPU works.
    """
    if device == "gpu":
        KERNEL.check_usable("cuda", 'device="gpu"', "Use device='cpu'.")
    return device == "gpu" or (device == "auto" and KERNEL.is_usable("cuda"))


def _test(platform: str) -> str | None:
    """Return why the kernels cannot run on the GPU; None if they scale a sum there as they should."""
    stream = open_gpu()
    sums, unit = stream.upload(np.array([6, -4], np.int64)), stream.upload(np.array([1, 2], np.float32))
    out = stream.zeros((2,), np.float32)
    stream.launch("scale_sums", 1, BLOCK, pack_words([sums, out, unit, None, 2, 2, 2, 0, 0.5]))
    found = stream.download(out).tolist()
    return None if found == [3.0, -4.0] else f"scaled sums are {found}, not [3.0, -4.0]"


KERNEL = Kernel("late_flights", "late sound is baked on the CPU", cuda=lambda: compile_sources(*SOURCES), test=_test)
