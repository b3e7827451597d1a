"""Steps per second: compile and run are timed apart."""

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

AHEAD = 2  # calls that an accelerator has before they begin
WARM = 10  # steps after a reset that are not timed
NUM_ACTIONS = 8


def compiled(function: Callable[..., Any], *args: Any) -> tuple[Callable[..., Any], float]:
    """A function compiled for these arguments, and the seconds that tracing and compiling took."""
    start = time.perf_counter()
    program = jax.jit(function).lower(*args).compile()
    return program, time.perf_counter() - start


def calls_per_second(program: Callable[..., Any], *args: Any, seconds: float = 1.0) -> float:
    """Rate of a compiled function, after one call to warm up."""
    jax.block_until_ready(program(*args))
    return _rate(lambda: program(*args), seconds)


def steps_per_second(
    step: Callable[[Any, jax.Array], Any], state: Any, actions: Sequence[jax.Array], seconds: float = 1.0
) -> float:
    """Rate of a compiled step from state to state, with actions in turn.

    After a reset everything is awake and settles. So what is timed begins after `WARM` steps, or as many as fit into
    `seconds`.
    """
    turns = itertools.cycle(actions)

    def advance() -> Any:
        nonlocal state
        state = step(state, next(turns))
        return state

    _rate(advance, seconds, WARM)
    return _rate(advance, seconds)


def _rate(call: Callable[[], Any], seconds: float, most: float = math.inf) -> float:
    """Calls per second of so many seconds, or of `most` calls.

    An accelerator has its next calls while it makes the last one, as in a loop that looks at nothing in between. A CPU
    would make them side by side.
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
    """Actions in [-1, 1] for some steps."""
    keys = jax.random.split(jax.random.key(0), NUM_ACTIONS)
    return [jax.random.uniform(key, shape, minval=-1.0) for key in keys]


def drawn_moves(shape: tuple[int, ...], num: int) -> list[jax.Array]:
    """Discrete actions for some steps, without the first one, `stop`."""
    keys = jax.random.split(jax.random.key(0), NUM_ACTIONS)
    return [jax.random.randint(key, shape, 1, num) for key in keys]


def peak_memory_bytes() -> dict[str, int]:
    """Largest resident size of this process, and of the device's allocator where it keeps count."""
    scale = 1 if sys.platform == "darwin" else 1024  # ru_maxrss is in kilobytes on Linux
    peak = {"host": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * scale}
    stats = jax.devices()[0].memory_stats() or {}
    if "peak_bytes_in_use" in stats:
        peak["device"] = int(stats["peak_bytes_in_use"])
    return peak


def versions() -> dict[str, str]:
    """Versions of what the figures depend on."""
    import importlib.metadata as metadata
    import platform

    from home_mjx import __version__  # not from its metadata, which a checkout on the path lacks

    names = ("jax", "jaxlib", "mujoco", "mujoco-mjx", "numba", "numpy")
    own = {"python": platform.python_version(), "home-mjx": __version__}
    return own | {name: metadata.version(name) for name in names}


def device_name() -> str:
    """Kind of the device, and how many processor cores stand behind a CPU device."""
    device = jax.devices()[0]
    if device.platform == "cpu":
        return f"cpu ({usable_cores()} cores)"
    return device.device_kind
