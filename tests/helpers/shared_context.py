"""One MLIR context for many programs: to make one, with all its dialects, takes longer than a small program."""

import threading
from typing import Any

from jax._src.interpreters import mlir

PROGRAMS = 64  # of one context, which keeps their constants and types until it is freed

_make = getattr(mlir, "make_ir_context", None)  # private: other versions of JAX may lack it
_here = threading.local()  # a context for each thread, since tests also compile in several


def install() -> None:
    """Share contexts from now on: before the first program is lowered."""
    if _make is not None:
        mlir.make_ir_context = shared_context


def shared_context() -> Any:
    """Return the context of this thread's programs before, or a new one once it served `PROGRAMS`."""
    left = getattr(_here, "left", 0)
    if left == 0:
        _here.context, left = _make(), PROGRAMS
    _here.left = left - 1
    return _here.context
