"""Dataset images, decoded with size limits."""

import io
from pathlib import Path

from PIL import Image, UnidentifiedImageError

from home_mjx.core.files import read_bytes
from home_mjx.errors import DatasetError

MAX_PIXELS = 1 << 26  # maximum decoded size: 8,192 x 8,192; SUNCG's images have at most 2,048 x 2,048


def open_texture(path: Path) -> Image.Image:
    """Read a PNG or JPEG file as an RGBA image.

    Args:
        path: A PNG or JPEG file.

    Raises:
        MissingFileError: The file is missing.
        DatasetError: The file is truncated, broken, of another format, or has more than `MAX_PIXELS` pixels. A few
            kilobytes can claim gigabytes, so the size is checked before anything is decoded.
    """
    try:
        image = Image.open(io.BytesIO(read_bytes(path)), formats=("PNG", "JPEG"))
        if image.width * image.height <= MAX_PIXELS:
            return image.convert("RGBA")
        reason = f"it has {image.width} x {image.height} pixels, at most {MAX_PIXELS} are decoded"
    except DatasetError:
        raise
    except UnidentifiedImageError:  # its message only contains a memory address
        reason = "it cannot be identified as PNG or JPEG"
    except Exception as error:  # a broken file can make Pillow raise anything
        reason = str(error) if isinstance(error, OSError) else f"{type(error).__name__}: {error}"
    raise DatasetError(f"cannot read texture: {reason}", file=path, hint="Restore the file, as 8-bit PNG or JPEG.")
