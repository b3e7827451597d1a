"""Radices of the FFTs of frames, on GPUs and on CPUs."""

RADICES = (8, 5, 4, 3, 2)  # of FFT passes; the first that divides a size is used, as in `cuda/fft.cuh` and `cpu/fft.py`


def radices(size: int) -> tuple[int, ...]:
    """Return the radices of a transform's passes in the order of `RADICES`; empty if the size has other factors.

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
    """Count the passes of a transform; 0 if its size has factors other than the radices.

    Example:
        >>> num_passes(2560), num_passes(2304), num_passes(14)
        (4, 5, 0)
    """
    return len(radices(size))
