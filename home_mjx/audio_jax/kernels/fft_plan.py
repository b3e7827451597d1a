"""Radices of the FFTs of frames, on GPUs and on CPUs."""

RADICES = (8, 5, 4, 3, 2)  # of FFT passes; the first that divides a size is used, as in `cuda/fft.cuh` and `cpu/fft.py`


def radices(size: int) -> tuple[int, ...]:
    """Return the radices of a transform's passes, each of `RADICES` in turn as often as it divides the remaining size.

    The result is empty if the size is 1 or has other prime factors than 2, 3 and 5.

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
    """Count the passes of a transform, see `radices`; 0 if its size is 1 or has prime factors other than 2, 3 and 5.

    Example:
        >>> num_passes(2560), num_passes(2304), num_passes(14)
        (4, 5, 0)
    """
    return len(radices(size))
