"""Native kernels: compilation on first use, availability by platform, and their calls.

A kernel is Numba code that XLA calls on CPUs, PTX that XLA launches on NVIDIA GPUs, or both. A fallback runs where
neither works. JAX traces a program for all platforms of a process. So where the CPU is not the default one, its code
is compiled only when a program is lowered for the CPU: Numba takes a minute, and programs for GPUs do not need it.
"""

import functools
import threading
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array

from home_mjx.core.native.fork_guard import record_process
from home_mjx.core.native.nvrtc import compile_ptx
from home_mjx.core.native.partition import run_untraced, varying_as
from home_mjx.core.native.platforms import local_devices, select_at_lowering
from home_mjx.errors import BackendError

PTX_TARGET = "__gpu$xla.gpu.ptx"  # XLA's custom-call target that launches PTX
TITLES = {"cpu": "CPU backend", "cuda": "NVIDIA GPU"}
GRID_AXES = 3

_registered: list[object] = []  # keeps functions alive that XLA may call until the process ends
_deferred: dict[str, "Kernel"] = {}  # kernels whose CPU version is compiled when a program is lowered for the CPU
_locks: dict[tuple["Kernel", str], threading.Lock] = {}  # of kernels and platforms: one thread starts each
_under_test = threading.local()  # `name`: the kernel whose test this thread runs


@dataclass(frozen=True, eq=False)
class Kernel:
    """A kernel of one package, which is compiled, registered and tested when a platform is first asked for.

    Attributes:
        name: Name of its CPU target, see `call_native`, and prefix of its symbols; unique in the process.
        fallback: Consequence of doing without it, for the warning.
        cpu: Imports its Numba code and returns the C functions `count` and `work` of `handler.build_handler`; None if
            it has no CPU version.
        cuda: Compiles its PTX and discards it, see `compile_sources`; None if it has no CUDA version.
        test: Runs it on a platform and returns the fault; None if the result is right.

    Example:
        >>> kernel = Kernel("my_sum", "sums are slower", cuda=lambda: compile_sources(Path("sum.cu"), SIZE=8))
        >>> kernel.find_problem("cpu")
        'the kernel has no version for this platform'
    """

    name: str
    fallback: str
    cpu: Callable[[], tuple[Any, Any]] | None = None
    cuda: Callable[[], object] | None = None
    test: Callable[[str], str | None] | None = None

    def find_problem(self, platform: str) -> str | None:
        """Return the reason why the kernel cannot be used on "cpu" or "cuda"; None if it works.

        The first call per platform compiles, registers and tests it; later ones return its answer. An exception then
        is also a reason, so that it does not end a program that works without the kernel.
        """
        with _locks.setdefault((self, platform), threading.Lock()):
            return _find_problem(self, platform)

    def is_usable(self, platform: str) -> bool:
        """Return whether `find_problem` is None; warn once if the kernel has a version for a device here that fails.

        Where the CPU is not the default platform, its version is taken to work, and `call_native` compiles it.
        """
        if platform == "cpu" and self.cpu and not _is_cpu_default():
            _deferred[self.name] = self
            return True
        return _is_usable(self, platform)

    def check_usable(self, platform: str, label: str, hint: str) -> None:
        """Raise `BackendError` if the kernel cannot be used on "cpu" or "cuda".

        `label` is the user's option and `hint` the advice in the message.
        """
        problem = self.find_problem(platform)
        if problem:
            raise BackendError(f"{label} is not available: {problem}", hint=hint)

    def select(self, fallback: Callable[..., Any], native: Mapping[str, Callable[..., Any]], *operands: Any) -> Any:
        """Return the results of `native`'s function for the platform of lowering if usable, else of `fallback`."""
        usable = {platform: run for platform, run in native.items() if self.is_usable(platform)}
        return select_at_lowering(fallback, usable, *operands)


@functools.cache
def compile_sources(*sources: Path, **defines: int) -> str:
    """Compile concatenated CUDA C files to PTX for all GPUs of this process, at least one; see `nvrtc.compile_ptx`.

    `defines` are integer macros by name.

    Raises:
        BackendError: NVRTC was not found, or it rejects the source.
    """
    capabilities = [int(device.compute_capability.replace(".", "")) for device in local_devices("cuda")]
    return compile_ptx(sources, min(capabilities), defines)


def call_native(
    name: str, operands: Sequence[Array], results: Sequence[jax.ShapeDtypeStruct], **attributes: int
) -> tuple[Array, ...]:
    """Call a kernel's CPU version and return its results.

    Args:
        name: Name of the kernel, which is usable on "cpu".
        operands: Arguments in the kernel's order; converted to float32 or int32.
        results: Shapes and dtypes of the results.
        attributes: Static int32 values, which the kernel reads in the order of their names.

    Raises:
        BackendError: When a program is lowered for the CPU, and the kernel has a fault.
    """
    values = {key: np.int32(value) for key, value in attributes.items()}
    if name in _deferred:
        operands = (_compile_at_lowering().bind(operands[0], name=name), *operands[1:])
    return _call(name, operands, results, values)


def launch_ptx(
    entry: str,
    ptx: str,
    grid: tuple[int, ...],
    threads: int,
    shared: int,
    operands: Sequence[Array],
    results: Sequence[jax.ShapeDtypeStruct],
) -> tuple[Array, ...]:
    """Launch a CUDA kernel and return its results.

    Args:
        entry: Name of the function in the PTX.
        ptx: PTX that defines it.
        grid: Number of blocks along up to three axes.
        threads: Threads per block.
        shared: Shared memory per block [bytes].
        operands: Arguments in the function's order; converted to float32 or int32. The results follow them.
        results: Shapes and dtypes of the results.
    """
    names = "grid_x", "grid_y", "grid_z", "block_x", "block_y", "block_z", "shared_mem_bytes"
    sizes = (*grid, *[1] * (GRID_AXES - len(grid)), threads, 1, 1, shared)
    launch: dict[str, Any] = {name: np.int32(size) for name, size in zip(names, sizes, strict=True)}
    return _call(PTX_TARGET, operands, results, launch | {"name": entry, "kernel_type": "ptx", "kernel_data": ptx})


def register_target(name: str, function: Any, *kept: object) -> None:
    """Register a C function as a CPU target of `jax.ffi.ffi_call` until the process ends.

    Args:
        name: Unique name of the target.
        function: `ctypes` function of the address of an `XLA_FFI_CallFrame`.
        kept: Other objects that must live as long, such as code that it calls.
    """
    record_process()
    _registered.append((function, *kept))
    jax.ffi.register_ffi_target(name, jax.ffi.pycapsule(function), platform="cpu", api_version=1)


def _call(
    target: str, operands: Sequence[Array], results: Sequence[jax.ShapeDtypeStruct], attributes: Mapping[str, Any]
) -> tuple[Array, ...]:
    """Call an FFI target with operands as of `_plain`; results vary over the operands' mesh axes."""
    plain = (_plain(x) for x in operands)
    return varying_as(operands, jax.ffi.ffi_call(target, tuple(results))(*plain, **attributes))


def _plain(operand: Array) -> Array:
    """Return an operand in float32 or int32; uint32 stays, since kernels read its bits and a conversion copies it."""
    if operand.dtype == jnp.uint32:
        return operand
    return operand.astype(jnp.float32 if jnp.issubdtype(operand.dtype, jnp.floating) else jnp.int32)


def _is_cpu_default() -> bool:
    """Return whether JAX's default device is a CPU: `jax_default_device` if set, else the default backend."""
    device = getattr(jax.config, "jax_default_device")  # noqa: B009 - not among the attributes that types declare
    return (getattr(device, "platform", device) or jax.default_backend()) == "cpu"


def _compile_deferred(name: str) -> None:
    """Compile a kernel of `_deferred` for the CPU, unless that is done; raise `BackendError` if it has a fault.

    It does nothing in the kernel's own test, which runs when the kernel is compiled.
    """
    if getattr(_under_test, "name", None) == name:
        return
    problem = _deferred[name].find_problem("cpu")
    if problem:
        hint = "With JAX_PLATFORMS=cpu, slower operations take over."
        raise BackendError(f"the kernel {name} does not work on the CPU: {problem}", hint=hint)


@functools.cache
def _compile_at_lowering() -> Any:
    """Return a JAX primitive: the identity, whose lowering for the CPU compiles the kernel `name` of `_deferred`."""
    from jax.extend.core import Primitive  # loads Pallas
    from jax.interpreters import batching, mlir

    def compile_kernel(operand: Any, *, name: str) -> Any:
        """Return the operand after compiling the kernel."""
        _compile_deferred(name)
        return operand

    primitive = Primitive("compile_kernel")
    primitive.def_impl(compile_kernel)
    primitive.def_abstract_eval(lambda operand, *, name: operand)
    mlir.register_lowering(primitive, lambda context, operand, *, name: [compile_kernel(operand, name=name)])
    batching.primitive_batchers[primitive] = lambda operands, axes, *, name: (
        primitive.bind(operands[0], name=name),
        axes[0],
    )
    return primitive


@functools.cache
def _is_usable(kernel: Kernel, platform: str) -> bool:
    """Return whether a kernel works on a platform; warn if it should, but does not. Cached."""
    problem = kernel.find_problem(platform)
    if problem and getattr(kernel, platform) and local_devices(platform):
        warnings.warn(f"{kernel.fallback}: {problem}", RuntimeWarning, stacklevel=4)
    return problem is None


@functools.cache
def _find_problem(kernel: Kernel, platform: str) -> str | None:
    """Return the reason why a kernel cannot be used on a platform, None if it works. Cached."""
    if getattr(kernel, platform) is None:
        return "the kernel has no version for this platform"
    if not local_devices(platform):
        return f"JAX has no {TITLES[platform]} in this process"
    try:
        return run_untraced(lambda: _start(kernel, platform))
    except Exception as error:
        return f"{type(error).__name__}: {error}"


def _start(kernel: Kernel, platform: str) -> str | None:
    """Compile, register and test a kernel on "cpu" or "cuda"; return the fault that its test finds, None if none."""
    if platform == "cpu" and kernel.cpu:
        record_process()
        from home_mjx.core.native.handler import build_handler

        functions = kernel.cpu()
        handler, task = build_handler(kernel.name, *functions)
        register_target(kernel.name, handler.ctypes, handler, task, *functions)
    elif kernel.cuda:
        kernel.cuda()
    if kernel.test is None:
        return None
    _under_test.name = kernel.name  # in a thread of its own, see `run_untraced`
    with jax.default_device(local_devices(platform)[0]):
        return kernel.test(platform)
