"""One MLIR context for many programs: to make one, with all its dialects, takes longer than a small program."""

from jax._src.interpreters import mlir

PROGRAMS = 64  # of one context, which keeps their constants and types until it is freed

_make = mlir.make_ir_context
_context, _left = None, 0


def install() -> None:
    """Before the first program is lowered."""
    mlir.make_ir_context = shared_context


def shared_context() -> mlir.ir.Context:
    """Return the context of the programs before, or a new one once it served `PROGRAMS`."""
    global _context, _left
    if _left == 0:
        _context, _left = _make(), PROGRAMS
    _left -= 1
    return _context
