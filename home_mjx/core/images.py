"""Images as files and bytes, decoded with size limits. Pillow is loaded by the first call, not by the import."""

import io
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from jaxtyping import UInt8

from home_mjx.core.files import read_bytes
from home_mjx.errors import DatasetError

if TYPE_CHECKING:
    from PIL.Image import Image

MAX_PIXELS = 1 << 26  # maximum decoded size: 8,192 x 8,192; SUNCG's images have at most 2,048 x 2,048


def open_texture(path: Path) -> "Image":
    """Read a PNG or JPEG file as an RGBA image.

    Args:
        path: A PNG or JPEG file.

    Raises:
        MissingFileError: The file is missing.
        DatasetError: The file is truncated, broken, of another format, or has more than `MAX_PIXELS` pixels. A few
            kilobytes can claim gigabytes, so the size is checked before anything is decoded.
    """
    from PIL import Image, UnidentifiedImageError

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


def read_texture(
    path: Path, size: int | None = None, resampling: Literal["box", "lanczos"] = "box"
) -> UInt8[np.ndarray, "h w 4"]:
    """Read a PNG or JPEG file as sRGB and alpha; errors as of `open_texture`.

    Args:
        path: A PNG or JPEG file.
        size: Edge of the square to which it is resized [px]; None: its own size.
        resampling: Filter of the resizing.
    """
    image = open_texture(path)
    if size is not None:
        from PIL.Image import Resampling

        image = image.resize((size, size), Resampling[resampling.upper()])
    return np.asarray(image)


def encode_png(image: UInt8[np.ndarray, "h w 3"]) -> bytes:
    """Return an sRGB image as a PNG file."""
    from PIL import Image

    out = io.BytesIO()
    Image.fromarray(image).save(out, "png", optimize=False)
    return out.getvalue()


def decode_image(data: bytes) -> np.ndarray:
    """Return the pixels of an image file.

    Raises:
        OSError, ValueError, SyntaxError: Pillow cannot decode it.
    """
    from PIL import Image

    with Image.open(io.BytesIO(data)) as image:
        return np.asarray(image)
