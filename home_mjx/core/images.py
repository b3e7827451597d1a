"""Images as files and bytes, decoded with size limits. Pillow is loaded by the first call, not by the import."""

import io
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from jaxtyping import Int, UInt8

from home_mjx.core.color import encode_srgb
from home_mjx.core.files import read_bytes
from home_mjx.errors import DatasetError

if TYPE_CHECKING:
    from PIL.Image import Image

MAX_PIXELS = 1 << 26  # maximum decoded size: 8,192 x 8,192; SUNCG's images have at most 2,048 x 2,048
MIN_OPAQUE_ALPHA = 128  # minimum alpha of an opaque texel; texels below it are cut out
REDUCING_GAP = 2.0  # images are first reduced by whole factors to this multiple of their size: thrice as fast
SRGB_GAMMA = 1 / 2.2  # gAMA chunk of sRGB images
GAMMA_TOLERANCE = 0.02  # difference from `SRGB_GAMMA` up to which no conversion is needed
PNG_DEPTH = 24  # byte of a PNG file that has the bits per sample, in the IHDR chunk
ORIENTATION = 0x0112  # EXIF tag
# Other formats by their first bytes, for messages.
OTHER_FORMATS = {b"GIF8": "GIF", b"BM": "BMP", b"II*\0": "TIFF", b"MM\0*": "TIFF", b"RIFF": "WebP", b"DDS ": "DDS"}


class _UnsupportedImageError(ValueError):
    """Reason why an image that Pillow decodes would have wrong pixels."""


def open_texture(path: Path) -> "Image":
    """Decode a PNG or JPEG file to an RGBA image in sRGB.

    Grey values of 16 bits are scaled to 8. Transparent colours and palette entries become alpha 0. Embedded ICC
    profiles and PNG gamma are converted to sRGB, and the EXIF orientation is applied. CMYK without a profile is
    converted without colour management; it is inverted if Adobe's marker says so. Animations give their first frame.

    Raises:
        MissingFileError: The file is missing.
        DatasetError: The file is empty, truncated, broken, of another format, or has more than `MAX_PIXELS` pixels. A
            few kilobytes can claim gigabytes, so the size is checked before anything is decoded. Also if a palette
            has fewer entries than the pixels use, a 16-bit RGB image has a transparent colour, or a profile does not
            fit its image.
    """
    from PIL import UnidentifiedImageError

    data = read_bytes(path)
    try:
        image = _identify(data)
        if image.width * image.height <= MAX_PIXELS:
            return _decode_rgba(image, data)
        reason = f"it has {image.width} x {image.height} pixels, at most {MAX_PIXELS} are decoded"
    except UnidentifiedImageError:  # its message only contains a memory address
        reason = "the file is empty" if not data else f"it cannot be identified as PNG or JPEG{_other_format(data)}"
    except _UnsupportedImageError as error:
        reason = str(error)
    except Exception as error:  # a broken file can make Pillow raise anything
        reason = str(error) if isinstance(error, OSError) else f"{type(error).__name__}: {error}"
    raise DatasetError(f"cannot read texture: {reason}", file=path, hint="Restore the file, as 8-bit PNG or JPEG.")


def has_cut_outs(path: Path) -> bool:
    """Return whether any pixel's alpha is below `MIN_OPAQUE_ALPHA`; files without alpha are not decoded (False).

    Raises:
        MissingFileError, DatasetError: As of `open_texture`.
    """
    data = read_bytes(path)
    try:
        image = _identify(data)
        if "A" not in image.getbands() and "transparency" not in image.info:
            return False
    except Exception:
        pass  # `open_texture` raises the typed error
    return int(np.asarray(open_texture(path).getchannel("A")).min()) < MIN_OPAQUE_ALPHA


def read_texture(
    path: Path, size: int | None = None, resampling: Literal["box", "lanczos"] = "box"
) -> UInt8[np.ndarray, "h w 4"]:
    """Read a PNG or JPEG file as sRGB and alpha, 0..255, first row on top; errors as of `open_texture`.

    Colours are weighted by alpha. Texels below `MIN_OPAQUE_ALPHA` get the colour of the nearest opaque texel, so that
    filters across the edge of a cut-out do not darken it.

    Args:
        path: A PNG or JPEG file.
        size: Edge of the square to which it is resized [px]; None: its own size.
        resampling: Filter of the resizing; without effect if `size` is None.
    """
    from PIL.Image import Resampling

    image, kernel = open_texture(path), Resampling[resampling.upper()]
    pixels = np.asarray(image if size is None else image.resize((size, size), kernel, reducing_gap=REDUCING_GAP))
    if size is None or int(np.asarray(image.getchannel("A")).min()) == 255:
        return _fill_cut_outs(pixels)
    if pixels[..., 3].max() < MIN_OPAQUE_ALPHA:  # nothing to weight by
        return np.dstack([np.asarray(image.convert("RGB").resize((size, size), kernel)), pixels[..., 3]])
    return _fill_cut_outs(_resize_weighted(np.asarray(image), size, kernel))


def _resize_weighted(pixels: UInt8[np.ndarray, "h w 4"], size: int, kernel: Any) -> UInt8[np.ndarray, "s s 4"]:
    """Resize to a square with colours weighted by alpha and Pillow's filter `kernel`; Pillow clips its own weights."""
    from PIL import Image

    alpha = pixels[..., 3].astype(np.float32)
    planes = [*(pixels[..., i] * alpha for i in range(3)), alpha]
    small = [np.asarray(Image.fromarray(plane).resize((size, size), kernel)) for plane in planes]
    color = np.stack(small[:3], axis=-1) / np.maximum(small[3], 1)[..., None]
    return np.round(np.clip(np.dstack([color, small[3]]), 0, 255)).astype(np.uint8)


def _fill_cut_outs(pixels: UInt8[np.ndarray, "h w 4"]) -> UInt8[np.ndarray, "h w 4"]:
    """Give texels with alpha below `MIN_OPAQUE_ALPHA` the colour of the nearest other one, if any; alpha is kept."""
    opaque = pixels[..., 3] >= MIN_OPAQUE_ALPHA
    if opaque.all() or not opaque.any():
        return pixels
    from scipy.ndimage import distance_transform_edt

    row, column = distance_transform_edt(~opaque, return_distances=False, return_indices=True)  # type: ignore
    return np.dstack([pixels[row, column, :3], pixels[..., 3]])


def _identify(data: bytes) -> "Image":
    """Return a lazily decoded image from a PNG or JPEG file's bytes; raise `UnidentifiedImageError` for others."""
    from PIL import Image

    return Image.open(io.BytesIO(data), formats=("PNG", "JPEG"))


def _other_format(data: bytes) -> str:
    """Return a remark on the format by a file's first bytes, such as ", but as GIF"; empty if it is unknown."""
    found = [name for start, name in OTHER_FORMATS.items() if data.startswith(start)]
    return f", but as {found[0]}" if found else ""


def _decode_rgba(image: "Image", data: bytes) -> "Image":
    """Decode an image to RGBA in sRGB and apply its EXIF orientation; `data` is the whole file."""
    from PIL import Image

    image.load()
    alpha = _decode_alpha(image, data[PNG_DEPTH] if image.format == "PNG" else 8)
    color = _convert_to_srgb(_reduce_to_bytes(image), image.info)
    color.putalpha(alpha)
    color.info = {}  # holds the profile and the transparent colour, which are applied already
    turn = {
        2: Image.Transpose.FLIP_LEFT_RIGHT,
        3: Image.Transpose.ROTATE_180,
        4: Image.Transpose.FLIP_TOP_BOTTOM,
        5: Image.Transpose.TRANSPOSE,
        6: Image.Transpose.ROTATE_270,
        7: Image.Transpose.TRANSVERSE,
        8: Image.Transpose.ROTATE_90,
    }.get(_orientation(image))
    return color if turn is None else color.transpose(turn)


def _orientation(image: "Image") -> int:
    """Return the EXIF orientation, 1 to 8; 1 if there is none, or if the metadata is broken, as viewers do."""
    try:
        return image.getexif().get(ORIENTATION, 1)
    except Exception:  # Pillow raises anything on broken metadata
        return 1


def _reduce_to_bytes(image: "Image") -> "Image":
    """Return the colours without alpha at 8 bits per channel, as an image of mode L, RGB or CMYK.

    Images of mode L, RGB or CMYK are unchanged, except CMYK without Adobe's marker, which is inverted. A palette with
    missing entries raises `_UnsupportedImageError`.
    """
    from PIL import Image, ImageChops

    if image.mode == "CMYK" and "adobe" not in image.info:  # Pillow inverts all CMYK, only Adobe's is stored inverted
        return ImageChops.invert(image)
    if image.mode in ("I;16", "I"):  # 16-bit grey; Pillow's own conversion clips at 255
        values = np.asarray(image).astype(np.uint32)
        return Image.fromarray(((values + 128) // 257).astype(np.uint8))
    if image.mode == "P":
        _check_palette(image)
        return image.convert("RGBA").convert("RGB")  # Pillow warns of direct conversions
    if image.mode in ("L", "RGB", "CMYK"):
        return image
    return image.convert("L" if image.mode in ("1", "LA") else "RGB")


def _check_palette(image: "Image") -> None:
    """Raise `_UnsupportedImageError` if pixels of mode P refer to missing palette entries, which Pillow shows black."""
    if image.palette is None:
        raise _UnsupportedImageError("it has no palette")
    count, largest = len(image.palette.palette) // len(image.palette.mode), int(np.asarray(image).max())  # type: ignore
    if largest >= count:
        raise _UnsupportedImageError(f"a pixel has the palette entry {largest} of {count}")


def _decode_alpha(image: "Image", depth: int) -> "Image":
    """Return alpha as an image of mode L: the image's own, else 0 at its transparent colour, else 255 everywhere.

    Palette entries may have any alpha. A transparent colour of 16-bit RGB raises `_UnsupportedImageError`. PNG stores a
    transparent colour in the lowest `depth` bits of 16; Pillow compares it with 8-bit values as it is.
    """
    from PIL import Image

    key = image.info.get("transparency")
    if key is None or image.mode in ("LA", "RGBA"):
        return image.getchannel("A") if "A" in image.getbands() else Image.new("L", image.size, 255)
    if image.mode == "P":
        return image.convert("RGBA").getchannel("A")
    if image.mode == "RGB" and depth == 16:
        raise _UnsupportedImageError("16-bit RGB with a transparent colour is not supported, only an alpha channel")
    if image.mode in ("L", "RGB"):
        key = np.asarray(key) % 2**depth
    if image.mode == "L" and depth < 8:
        key = key * 255 // (2**depth - 1)
    keyed = np.asarray(image.convert("L") if image.mode == "1" else image) == np.asarray(key)
    keyed = keyed.all(axis=-1) if keyed.ndim == 3 else keyed
    return Image.fromarray(np.where(keyed, 0, 255).astype(np.uint8))


def _convert_to_srgb(image: "Image", info: dict) -> "Image":
    """Convert colours (L, RGB or CMYK) to sRGB, mode RGB, by `info`: ICC profile, else PNG gamma, else as if sRGB."""
    if info.get("icc_profile"):
        return _apply_profile(image, info["icc_profile"])
    image, gamma = image.convert("RGB"), info.get("gamma", 0)
    if "srgb" in info or gamma <= 0 or abs(gamma - SRGB_GAMMA) <= GAMMA_TOLERANCE:
        return image
    curve = encode_srgb((np.arange(256) / 255) ** (1 / gamma))
    return image.point(np.round(255 * curve).astype(int).tolist() * 3)


def _apply_profile(image: "Image", data: bytes) -> "Image":
    """Convert colours (L, RGB or CMYK) to sRGB by ICC profile; `_UnsupportedImageError` if it is broken or unfit."""
    from PIL import ImageCms

    try:
        profile = ImageCms.ImageCmsProfile(io.BytesIO(data))
        space = profile.profile.xcolor_space.strip()  # type: ignore
        if space == "RGB" and image.mode != "CMYK" and "srgb" in ImageCms.getProfileDescription(profile).lower():
            return image.convert("RGB")
        if space == "RGB" and image.mode == "L":
            image = image.convert("RGB")
        if {"RGB": "RGB", "GRAY": "L", "CMYK": "CMYK"}.get(space) != image.mode:
            raise _UnsupportedImageError(f"its colour profile is for {space}, its pixels are {image.mode}")
        return ImageCms.profileToProfile(image, profile, ImageCms.createProfile("sRGB"), outputMode="RGB")  # type: ignore
    except (OSError, ImageCms.PyCMSError) as error:
        raise _UnsupportedImageError(f"its colour profile is broken: {error}") from error


def encode_png(image: UInt8[np.ndarray, "h w 3"]) -> bytes:
    """Return an sRGB image as a PNG file's bytes; with a palette, which is smaller, for at most 256 colours."""
    from PIL import Image

    out, picture = io.BytesIO(), Image.fromarray(image)
    if colors := picture.getcolors(256):
        palette = np.array(sorted(color for _, color in colors), np.uint8)
        picture = Image.fromarray(np.searchsorted(_pack(palette), _pack(image)).astype(np.uint8))
        picture.putpalette(palette.tobytes())
    picture.save(out, "png", compress_level=1 if colors else 6)
    return out.getvalue()


def _pack(colors: UInt8[np.ndarray, "*n 3"]) -> Int[np.ndarray, "*n"]:
    """Return one integer per colour, in the order of red, then green, then blue."""
    red, green, blue = np.moveaxis(colors.astype(np.int32), -1, 0)
    return red << 16 | green << 8 | blue


def decode_image(data: bytes) -> np.ndarray:
    """Return the pixels of an image file's bytes in its own mode: (h, w) or (h, w, channels), first row on top.

    Images with a palette become RGB.

    Raises:
        OSError, ValueError, SyntaxError: Pillow cannot decode it.
        DecompressionBombError: It has more pixels than Pillow's own limit; `MAX_PIXELS` does not apply.
    """
    from PIL import Image

    with Image.open(io.BytesIO(data)) as image:
        return np.asarray(image.convert("RGB") if image.mode == "P" else image)
