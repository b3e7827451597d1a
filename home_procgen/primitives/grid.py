"""Rounding that makes shapes independent of the CPU on which they are built."""

import numpy as np
from jaxtyping import Float

_DECIMALS = 9  # of a metre


def round_shape(values: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n"]:
    """Return coordinates or directions rounded to nine decimals.

    Sines, powers and matrix products differ in the last bit between CPUs. Shapes depend on comparisons, many of which
    are ties but for such bits, so their operands are rounded first. After that, only sums, products, quotients and
    square roots keep equal bits; `@` and `np.linalg.norm` of one vector call BLAS.
    """
    return np.round(values, _DECIMALS) + 0.0
