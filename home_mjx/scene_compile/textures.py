"""Image files as one array of layers."""

import io
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float, UInt8
from PIL import Image, UnidentifiedImageError

from home_mjx.errors import ConfigError, DatasetError
from home_mjx.scene_compile.color_space import decode_srgb, encode_srgb
from home_mjx.scene_compile.compiled import TextureArray
from home_mjx.scene_compile.padding import size_class
from home_mjx.scene_compile.suncg.files import read_bytes

TEXTURE_SIZE = 128  # [px]
MAX_PIXELS = 1 << 26  # 8,192 x 8,192; SUNCG's are up to 2,048 x 2,048


def load_textures(paths: Sequence[str], size: int = TEXTURE_SIZE) -> TextureArray:
    """Images as sRGB and alpha layers, each with its mip levels; layers beyond the last image are white.

    Args:
        paths: Image files.
        size: Edge of the square layers [px], a power of two.

    Raises:
        DatasetError: As `open_texture`.
        ConfigError: `size` is no power of two.
    """
    if size < 1 or size & (size - 1):
        raise ConfigError(f"the edge of texture layers must be a power of two, got {size}")
    layers = np.full((_num_layers(len(paths)), sum(mip_sizes(size)), 4), 255, np.uint8)
    for layer, path in zip(layers, paths, strict=False):
        image = open_texture(Path(path)).resize((size, size), Image.Resampling.LANCZOS)
        layer[...] = mip_levels(np.asarray(image))
    return layers


def mip_sizes(size: int) -> list[int]:
    """Texels of each mip level of a square texture, from the full size down to one.

    Example:
        >>> mip_sizes(4)
        [16, 4, 1]
    """
    return [(size >> level) ** 2 for level in range(size.bit_length())]


def mip_levels(image: UInt8[np.ndarray, "s s 4"]) -> UInt8[np.ndarray, "p 4"]:
    """A texture and its halvings, row by row after one another; each texel is the mean of four, in linear light.

    Texels count by their opacity, so that what is cut away does not bleed into what stays.
    """
    color, alpha = decode_srgb(image[..., :3] / 255.0), image[..., 3:] / 255.0
    levels = [image.reshape(-1, 4)]
    while len(color) > 1:
        weight = np.maximum(alpha, 1e-6)
        alpha = _halved(alpha)
        color = _halved(color * weight) / np.maximum(_halved(weight), 1e-6)
        levels.append(
            np.round(255 * np.concatenate([encode_srgb(color), alpha], axis=-1)).astype(np.uint8).reshape(-1, 4)
        )
    return np.concatenate(levels)


def _halved(values: Float[np.ndarray, "s s c"]) -> Float[np.ndarray, "s2 s2 c"]:
    size = len(values) // 2
    return values.reshape(size, 2, size, 2, -1).mean(axis=(1, 3))


def _num_layers(count: int) -> int:
    return size_class(count, 1)


def texture_bytes(count: int, size: int = TEXTURE_SIZE) -> int:
    """What the layers of `count` images take."""
    return _num_layers(count) * sum(mip_sizes(size)) * 4


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
    except UnidentifiedImageError:  # whose text names an object in memory
        reason = "it cannot be identified as PNG or JPEG"
    except Exception as error:  # Pillow raises whatever a broken file makes its decoders stumble over
        reason = str(error) if isinstance(error, OSError) else f"{type(error).__name__}: {error}"
    raise DatasetError(f"cannot read texture: {reason}", file=path, hint="Restore the file, as 8-bit PNG or JPEG.")
