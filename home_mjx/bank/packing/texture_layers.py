"""Loading of image files into one array of texture layers."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float, UInt8, UInt32

from home_mjx.bank.packing.capacity import size_class
from home_mjx.core.color import decode_srgb, encode_srgb
from home_mjx.core.images import MIN_OPAQUE_ALPHA, read_texture
from home_mjx.core.workers import map_threads
from home_mjx.errors import ConfigError
from home_mjx.schema.compiled import TextureArray

TEXTURE_SIZE, MAX_TEXTURE_SIZE = 128, 512  # [px], default edge of a layer, and the largest for large images
WORD_BITS = 32
LINEAR = decode_srgb(np.arange(256) / 255.0)  # linear light of each sRGB value


def texture_size_for(edge: int) -> int:
    """Return the edge of texture layers for images with this edge [px], rounded up to 128, 256 or 512, the maximum.

    Example:
        >>> texture_size_for(64), texture_size_for(240), texture_size_for(1080)
        (128, 256, 512)
    """
    return min(max(size_class(edge, TEXTURE_SIZE), TEXTURE_SIZE), MAX_TEXTURE_SIZE)


def load_textures(paths: Sequence[str], size: int = TEXTURE_SIZE) -> TextureArray:
    """Load images in parallel as sRGB and alpha layers (layer, texel, 4) with mip levels, in the order of `paths`.

    The number of layers is that of `texture_shape`; layers without an image are opaque white.

    Args:
        paths: Image files, which are resized to squares.
        size: Edge of the square layers [px], a power of two.

    Raises:
        DatasetError: An image cannot be read, see `read_texture`.
        ConfigError: `size` is not a power of two.
    """
    if size < 1 or size & (size - 1):
        raise ConfigError(f"the edge of texture layers must be a power of two, got {size}")
    layers = np.full((*texture_shape(len(paths), size), 4), 255, np.uint8)

    def fill(number: int) -> None:
        """Write the mip levels of one image into its layer."""
        layers[number] = mip_levels(read_texture(Path(paths[number]), size, "lanczos"))

    map_threads(fill, range(len(paths)))
    return layers


def cutout_bits(layers: TextureArray, size: int) -> UInt32[np.ndarray, "l s w"]:
    """Return a bit per texel of the largest mip level (edge `size` [px]), lowest bit first; 1: cut out.

    Texels with an alpha below `MIN_OPAQUE_ALPHA` are cut out. Rows are padded with 0 to whole words of 32 bits.
    """
    holes = layers[:, : size * size, 3].reshape(-1, size, size) < MIN_OPAQUE_ALPHA
    padded = np.pad(holes, ((0, 0), (0, 0), (0, -size % WORD_BITS)))
    return np.packbits(padded, axis=-1, bitorder="little").view("<u4")


def cutout_shape(size: int = TEXTURE_SIZE) -> tuple[int, int]:
    """Return the number of rows of one layer of `cutout_bits`, which is `size`, and of 32-bit words per row."""
    return size, -(-size // WORD_BITS)


def mip_sizes(size: int) -> list[int]:
    """Return the texel counts of a square texture's mip levels, from `size` x `size` to one; odd edges halve down.

    Example:
        >>> mip_sizes(4)
        [16, 4, 1]
    """
    return [(size >> level) ** 2 for level in range(size.bit_length())]


def mip_levels(image: UInt8[np.ndarray, "s s 4"]) -> UInt8[np.ndarray, "p 4"]:
    """Return a texture's mip levels, largest first, row by row; its edge is a power of two.

    The first level is the image itself. A texel is the mean of four in linear light, weighted by opacity, so that
    colours of transparent texels do not bleed into visible ones. Its alpha is their plain mean.
    """
    color, alpha = LINEAR[image[..., :3]], image[..., 3:] / 255.0
    levels = [image.reshape(-1, 4)]
    while len(color) > 1:
        weight = np.maximum(alpha, 1e-6)
        alpha = _halved(alpha)
        color = _halved(color * weight) / np.maximum(_halved(weight), 1e-6)
        level = np.round(255 * np.concatenate([encode_srgb(color), alpha], axis=-1))
        levels.append(level.astype(np.uint8).reshape(-1, 4))
    return np.concatenate(levels)


def _halved(values: Float[np.ndarray, "s s c"]) -> Float[np.ndarray, "s2 s2 c"]:
    """Return the means of 2 x 2 blocks; the edge must be even."""
    size = len(values) // 2
    return values.reshape(size, 2, size, 2, -1).mean(axis=(1, 3))


def texture_shape(count: int, size: int = TEXTURE_SIZE) -> tuple[int, int]:
    """Return the layers for `count` images, the next power of two (at least 1), and texels per layer in all mip levels.

    `size` is the edge of the largest level [px].
    """
    return size_class(count, 1), sum(mip_sizes(size))


def texture_bytes(count: int, size: int = TEXTURE_SIZE) -> int:
    """Return the bytes of `texture_shape` layers for `count` images, with their cut-out bits."""
    layers, texels = texture_shape(count, size)
    rows, words = cutout_shape(size)
    return layers * (texels + rows * words) * 4
