"""Size classes of array lengths: few distinct lengths let similar banks share one compiled step."""


def size_class(count: int, smallest: int) -> int:
    """Return the smallest `smallest * 2**n` of at least `count`.

    Example:
        >>> size_class(44, 32), size_class(3, 8)
        (64, 8)
    """
    size = smallest
    while size < count:
        size *= 2
    return size


def ragged_class(count: int) -> int:
    """Return the capacity of a concatenated table: at least four classes per octave, so at most a quarter is unused.

    Example:
        >>> ragged_class(1000), ragged_class(102_076)
        (1024, 114688)
    """
    step = 64
    while step * 8 < count:
        step *= 2
    return -(-max(count, 1) // step) * step
