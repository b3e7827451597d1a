"""What transforms of frames are made of, on GPUs and on CPUs."""

RADICES = (8, 5, 4, 3, 2)  # of passes, the largest that divides a size first, as in `cuda/fft.cuh` and `cpu/fft.py`


def num_passes(size: int) -> int:
    """Passes of a transform; 0: it has other factors than the radices.

    Example:
        >>> num_passes(2560), num_passes(2304), num_passes(14)
        (4, 5, 0)
    """
    passes = 0
    for radix in RADICES:
        while size % radix == 0:
            size, passes = size // radix, passes + 1
    return passes if size == 1 else 0
