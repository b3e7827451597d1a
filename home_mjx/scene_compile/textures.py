"""Image files as one array of layers."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from PIL import Image

from home_mjx.errors import DatasetError
from home_mjx.scene_compile.compiled import TextureArray
from home_mjx.scene_compile.padding import size_class

TEXTURE_SIZE = 128  # [px]


def load_textures(paths: Sequence[str], size: int = TEXTURE_SIZE) -> TextureArray:
    """Images as sRGB and alpha layers, row 0 at the top; layers beyond the last image are white.

    Args:
        paths: Image files.
        size: Edge of the square layers [px].

    Raises:
        DatasetError: A file is missing or is no image.
    """
    layers = np.full((size_class(len(paths), 1), size, size, 4), 255, np.uint8)
    for layer, path in zip(layers, paths, strict=False):
        layer[...] = _load_texture(Path(path), size)
    return layers


def _load_texture(path: Path, size: int) -> np.ndarray:
    try:
        with Image.open(path) as image:
            return np.asarray(image.convert("RGBA").resize((size, size), Image.Resampling.LANCZOS))
    except OSError as error:
        raise DatasetError(f"cannot read texture: {error}", file=path, hint="Restore the file.") from error
