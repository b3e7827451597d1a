"""On which platforms of this process own kernels work, and the GPU's kernels themselves."""

import threading
import warnings
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import jax
from jax.extend.backend import backends

from home_mjx.core.native.nvrtc import NO_DEFINES, compile_ptx

PTX_TARGET = "__gpu$xla.gpu.ptx"  # XLA's own call of a kernel given as PTX
TITLES = {"cpu": "CPU backend", "cuda": "NVIDIA GPU"}
PLATFORMS = {"gpu": "cuda"}  # JAX's name of a backend -> that of the platform programs are lowered for


def devices_of(platform: str) -> list[Any]:
    """The devices of a platform ("cpu" or "cuda") that JAX has in this process."""
    try:
        return jax.local_devices(backend=platform)
    except RuntimeError:
        return []


def problem_of(platform: str, start: Callable[[], str | None]) -> str | None:
    """Why kernels cannot be used on a platform; None if they work.

    Args:
        platform: "cpu" or "cuda".
        start: Compiles, registers and tests them; gives the fault or None. What it raises is a fault, too: it must not
            end a program that can do without.
    """
    if not devices_of(platform):
        return f"JAX has no {TITLES[platform]} here"
    answer: list[str | None] = []

    def run() -> None:
        try:
            answer.append(start())
        except Exception as error:
            answer.append(f"{type(error).__name__}: {error}")

    # In its own thread: the caller may be in the middle of a trace, or under a mesh.
    thread = threading.Thread(target=run)
    thread.start()
    thread.join()
    return answer[0]


def works(platform: str, problem: str | None, instead: str) -> bool:
    """Whether there is no problem; warns if there is one although the platform is here: `instead` says what is used."""
    if problem and devices_of(platform):
        warnings.warn(f"{instead}: {problem}", RuntimeWarning, stacklevel=3)
    return problem is None


def cover_all(platforms: Iterable[str]) -> bool:
    """Whether all platforms of this process are among these.

    JAX traces every branch of `platform_dependent`, whichever is lowered. A default that cannot be chosen should
    therefore be left out.
    """
    return {PLATFORMS.get(name, name) for name in backends()} <= set(platforms)


def ptx_for_all(source: Path | Sequence[Path], defines: Mapping[str, int] = NO_DEFINES) -> str:
    """PTX of CUDA C that all GPUs of this process can run; see `nvrtc.compile_ptx`."""
    capabilities = [int(device.compute_capability.replace(".", "")) for device in devices_of("cuda")]
    return compile_ptx(source, min(capabilities), defines)
