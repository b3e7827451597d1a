"""Image files as one array of layers."""

import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image

from home_mjx.errors import DatasetError
from home_mjx.scene_compile.compiled import TextureArray
from home_mjx.scene_compile.padding import size_class
from home_mjx.scene_compile.suncg.files import read_bytes

TEXTURE_SIZE = 128  # [px]
MAX_PIXELS = 1 << 25  # 5,792 x 5,792; SUNCG's are up to 2,048 x 2,048


def load_textures(paths: Sequence[str], size: int = TEXTURE_SIZE) -> TextureArray:
    """Images as sRGB and alpha layers, row 0 at the top; layers beyond the last image are white.

    Args:
        paths: Image files.
        size: Edge of the square layers [px].

    Raises:
        DatasetError: As `open_texture`.
    """
    layers = np.full((size_class(len(paths), 1), size, size, 4), 255, np.uint8)
    for layer, path in zip(layers, paths, strict=False):
        layer[...] = np.asarray(open_texture(Path(path)).resize((size, size), Image.Resampling.LANCZOS))
    return layers


def open_texture(path: Path) -> Image.Image:
    """A decoded image with red, green, blue and alpha.

    Args:
        path: A PNG or JPEG file.

    Raises:
        DatasetError: The file is missing, truncated or broken, is of another kind, or has more than `MAX_PIXELS`:
            a few kilobytes can claim gigabytes, so that is checked before anything is decoded.
    """
    try:
        image = Image.open(io.BytesIO(read_bytes(path)), formats=("PNG", "JPEG"))
        if image.width * image.height <= MAX_PIXELS:
            return image.convert("RGBA")
        reason = f"it has {image.width} x {image.height} pixels, at most {MAX_PIXELS} are decoded"
    except DatasetError:
        raise
    except Exception as error:  # Pillow raises whatever a broken file makes its decoders stumble over
        reason = str(error) if isinstance(error, OSError) else f"{type(error).__name__}: {error}"
    raise DatasetError(f"cannot read texture: {reason}", file=path, hint="Restore the file, as 8-bit PNG or JPEG.")
