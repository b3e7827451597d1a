"""Programs that count their own traces."""

from collections.abc import Callable
from typing import Any

import jax


class CountedJit:
    """A function under `jax.jit`, and how often it was traced.

    JAX shares one cache between all jitted functions of a process, and evicts entries of functions in use.
    """

    def __init__(self, function: Callable[..., Any]):
        self.traces = 0
        self._function = function
        self._program = jax.jit(self._counted)

    def __call__(self, *args: Any) -> Any:
        return self._program(*args)

    def _counted(self, *args: Any) -> Any:
        self.traces += 1
        return self._function(*args)
