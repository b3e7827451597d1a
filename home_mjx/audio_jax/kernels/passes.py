"""What transforms of frames are made of, on GPUs and on CPUs."""

RADICES = (8, 5, 4, 3, 2)  # of passes, the largest that divides a size first, as in `cuda/fft.cuh` and `cpu/fft.py`


def radices(size: int) -> tuple[int, ...]:
    """Of the passes of a transform, the largest ones first; none if it has other factors.

    Example:
        >>> radices(2560), radices(14)
        ((8, 8, 8, 5), ())
    """
    found = []
    for radix in RADICES:
        while size % radix == 0:
            size //= radix
            found.append(radix)
    return tuple(found) if size == 1 else ()


def num_passes(size: int) -> int:
    """Passes of a transform; 0: it has other factors than the radices.

    Example:
        >>> num_passes(2560), num_passes(2304), num_passes(14)
        (4, 5, 0)
    """
    return len(radices(size))
