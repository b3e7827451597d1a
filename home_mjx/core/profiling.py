"""Timing of compiled programs; compilation and execution are timed separately."""

import itertools
import math
import resource
import sys
import time
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any

import jax

from home_mjx.core.workers import usable_cores

AHEAD = 2  # calls queued on an accelerator in advance
WARM = 10  # untimed steps after a reset
NUM_ACTIONS = 8


def compiled(
    function: Callable[..., Any], *args: Any, options: dict[str, str | bool] | None = None
) -> tuple[Callable[..., Any], float]:
    """Compile a function for the shapes of `args`; return the program and the time of tracing and compiling [s].

    `options` are XLA's, such as those of `compiler_options`.
    """
    start = time.perf_counter()
    program = jax.jit(function).lower(*args).compile(options)
    return program, time.perf_counter() - start


def calls_per_second(program: Callable[..., Any], *args: Any, seconds: float = 1.0) -> float:
    """Return the rate [1/s] of calls of a compiled function, measured over `seconds` [s] after one warm-up call."""
    jax.block_until_ready(program(*args))
    return _rate(lambda: program(*args), seconds)


def steps_per_second(
    step: Callable[[Any, jax.Array], Any], state: Any, actions: Sequence[jax.Array], seconds: float = 1.0
) -> float:
    """Return the rate [1/s] of `step(state, action)`, measured over `seconds` [s] with cyclic actions.

    After a reset all bodies are awake and settle, so timing starts after `WARM` steps or `seconds`, whichever is first.
    """
    turns = itertools.cycle(actions)

    def advance() -> Any:
        """Make one step with the next action, and return the new state."""
        nonlocal state
        state = step(state, next(turns))
        return state

    _rate(advance, seconds, WARM)
    return _rate(advance, seconds)


def _rate(call: Callable[[], Any], seconds: float, most: float = math.inf) -> float:
    """Return calls per second, measured until `seconds` [s] or `most` calls are over, whichever is first.

    On an accelerator the next calls are queued while one runs, as in a loop without host synchronisation. A CPU would
    run them concurrently, so there they are not queued.
    """
    ahead = 0 if jax.default_backend() == "cpu" else AHEAD
    start, calls, sent = time.perf_counter(), 0, deque[Any]()
    while time.perf_counter() - start < seconds and calls < most:
        sent.append(call())
        calls += 1
        if len(sent) > ahead:
            jax.block_until_ready(sent.popleft())
    jax.block_until_ready(sent)
    return calls / (time.perf_counter() - start)


def drawn_actions(shape: tuple[int, ...]) -> list[jax.Array]:
    """Return `NUM_ACTIONS` arrays of `shape`, uniform in [-1, 1), one per step; equal in all calls."""
    keys = jax.random.split(jax.random.key(0), NUM_ACTIONS)
    return [jax.random.uniform(key, shape, minval=-1.0) for key in keys]


def drawn_moves(shape: tuple[int, ...], num: int) -> list[jax.Array]:
    """Return `NUM_ACTIONS` integer arrays of `shape`, one per step, uniform in 1..`num - 1`, so without 0 (`stop`)."""
    keys = jax.random.split(jax.random.key(0), NUM_ACTIONS)
    return [jax.random.randint(key, shape, 1, num) for key in keys]


def peak_memory_bytes() -> dict[str, int]:
    """Return the peak memory [bytes] of this process as `host`, and of JAX's first device as `device`, if known."""
    scale = 1 if sys.platform == "darwin" else 1024  # ru_maxrss is in kilobytes on Linux
    peak = {"host": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * scale}
    stats = jax.devices()[0].memory_stats() or {}
    if "peak_bytes_in_use" in stats:
        peak["device"] = int(stats["peak_bytes_in_use"])
    return peak


def versions() -> dict[str, str]:
    """Return the versions of Python and the relevant packages by name; `PackageNotFoundError` if one is missing."""
    import importlib.metadata as metadata
    import platform

    names = ("jax", "jaxlib", "mujoco", "mujoco-mjx", "numba", "numpy")
    own = {"python": platform.python_version(), "home-mjx": sys.modules["home_mjx"].__version__}
    return own | {name: metadata.version(name) for name in names}


def device_name() -> str:
    """Return the kind of JAX's first device; for a CPU "cpu (8 cores)", with its number of usable cores."""
    device = jax.devices()[0]
    if device.platform == "cpu":
        return f"cpu ({usable_cores()} cores)"
    return device.device_kind
