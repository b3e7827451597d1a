"""Every kind of PNG and JPEG that Pillow reads has the right colours and alpha, or is refused with file and reason."""

import io
import struct
import zlib

import numpy as np
import pytest
from PIL import Image, ImageCms
from png_files import encoded, png_of

from home_mjx.core.images import decode_image, encode_png, has_cut_outs, open_texture, read_texture
from home_mjx.errors import DatasetError

GREY, RGB, PALETTE, GREY_ALPHA, RGBA = 0, 2, 3, 4, 6  # colour types of PNG
WIDE = struct.pack(">6H", 0x0102, 0x0202, 0x0302, 0xFFFF, 0, 0)
MODES = ("1", "L", "LA", "La", "P", "PA", "RGB", "RGBX", "RGBA", "RGBa", "CMYK", "YCbCr", "LAB", "HSV")
MODES += ("I;16", "I;16L", "I;16B", "I", "F")
FORMATS = ("PNG", "JPEG", "TGA", "BMP", "TIFF", "GIF", "WEBP", "JPEG2000", "PPM", "ICO")


def png(width, depth, kind, row, **chunks):
    """A PNG of one row, with more chunks by name."""
    header = struct.pack(">IIBBBBB", width, 1, depth, kind, 0, 0, 0)
    every = [(b"IHDR", header), *((k.encode(), v) for k, v in chunks.items())]
    return png_of([*every, (b"IDAT", zlib.compress(b"\0" + row)), (b"IEND", b"")])


@pytest.fixture
def write(tmp_path):
    def to_file(data, name="a.png"):
        path = tmp_path / name
        path.write_bytes(data)
        return path

    return to_file


def pixels(path):
    return [tuple(x) for x in np.asarray(open_texture(path)).reshape(-1, 4).tolist()]


def grey(*values, clear=()):
    return [(v, v, v, 0 if i in clear else 255) for i, v in enumerate(values)]


@pytest.mark.parametrize(
    ("data", "expected"),
    [
        (png(4, 1, GREY, b"\x50"), grey(0, 255, 0, 255)),
        (png(4, 1, GREY, b"\x50", tRNS=b"\0\1"), grey(0, 255, 0, 255, clear=(1, 3))),
        (png(4, 1, GREY, b"\x50", tRNS=b"\0\0"), grey(0, 255, 0, 255, clear=(0, 2))),
        (png(4, 2, GREY, b"\x1b"), grey(0, 85, 170, 255)),
        (png(4, 2, GREY, b"\x1b", tRNS=b"\0\3"), grey(0, 85, 170, 255, clear=(3,))),
        (png(4, 4, GREY, b"\x05\xaf", tRNS=b"\0\5"), grey(0, 85, 170, 255, clear=(1,))),
        (png(3, 8, GREY, b"\x05\xaf\xff", tRNS=b"\0\5"), grey(5, 175, 255, clear=(0,))),
        (png(4, 16, GREY, struct.pack(">4H", 0, 0x8000, 0xFF00, 0xFFFF)), grey(0, 128, 254, 255)),
        (png(3, 16, GREY, struct.pack(">3H", 5, 0x8000, 0x8001), tRNS=b"\x80\0"), grey(0, 128, 128, clear=(1,))),
        (png(2, 16, GREY_ALPHA, struct.pack(">4H", 0x0101, 0x7FFF, 0xFFFF, 0xFFFF)), [(1, 1, 1, 127), (255,) * 4]),
        (png(2, 8, RGB, b"\1\2\3\xff\0\0", tRNS=b"\0\1\0\2\0\3"), [(1, 2, 3, 0), (255, 0, 0, 255)]),
        # The bits of a transparent colour above the depth do not count; some encoders repeat the sample in them.
        (png(2, 8, RGB, b"\1\2\3\xff\0\0", tRNS=b"\1\1\2\2\3\3"), [(1, 2, 3, 0), (255, 0, 0, 255)]),
        (png(3, 8, GREY, b"\x05\xaf\xff", tRNS=b"\5\5"), grey(5, 175, 255, clear=(0,))),
        (png(4, 4, GREY, b"\x05\xaf", tRNS=b"\x55\x55"), grey(0, 85, 170, 255, clear=(1,))),
        (png(2, 16, RGB, WIDE), [(1, 2, 3, 255), (255, 0, 0, 255)]),
        (png(1, 16, RGBA, struct.pack(">4H", 0x0101, 0x0202, 0x0303, 0x8080)), [(1, 2, 3, 128)]),
        (png(2, 4, PALETTE, b"\x01", PLTE=bytes(range(6)), tRNS=b"\0"), [(0, 1, 2, 0), (3, 4, 5, 255)]),
        (png(2, 8, PALETTE, b"\0\1", PLTE=bytes(range(6)), tRNS=b"\xff\x80"), [(0, 1, 2, 255), (3, 4, 5, 128)]),
        (png(2, 8, PALETTE, b"\0\1", PLTE=bytes(range(6))), [(0, 1, 2, 255), (3, 4, 5, 255)]),
        (png(2, 8, GREY, b"\x80\xff", gAMA=struct.pack(">I", 100000)), grey(188, 255)),
        (png(2, 8, GREY, b"\x80\xff", gAMA=struct.pack(">I", 45455)), grey(128, 255)),
        (png(2, 8, GREY, b"\x80\xff", sRGB=b"\0", gAMA=struct.pack(">I", 100000)), grey(128, 255)),
    ],
)
def test_png_of_every_depth(write, data, expected):
    path = write(data)
    assert pixels(path) == expected
    assert has_cut_outs(path) == any(x[3] < 128 for x in expected)


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        (b"", "the file is empty"),
        (
            png(2, 16, RGB, WIDE, tRNS=struct.pack(">3H", 0x0102, 0x0202, 0x0302)),
            "16-bit RGB with a transparent colour",
        ),
        (png(2, 8, PALETTE, b"\1\x20", PLTE=bytes(range(9))), "a pixel has the palette entry 32 of 3"),
        (png(2, 8, PALETTE, b"\0\1"), "it has no palette"),
        (png(2, 8, RGB, b"\1\2\3"), "truncated"),
        (encoded(Image.new("RGB", (2, 2)), "GIF"), "but as GIF"),
        (encoded(Image.new("RGB", (2, 2)), icc_profile=b"nothing"), "its colour profile is broken"),
    ],
)
def test_refused_images_name_file_and_reason(write, data, reason):
    path = write(data)
    for read in (open_texture, has_cut_outs, read_texture):
        if read is has_cut_outs and reason.startswith(("a pixel", "it has no", "truncated", "its colour")):
            continue  # opaque images are not decoded there
        with pytest.raises(DatasetError, match="cannot read texture") as caught:
            read(path)
        assert reason in caught.value.message
        assert caught.value.file == str(path)


def mid_grey(mode):
    """A mid grey, opaque where the mode has alpha; white in mode 1."""
    if mode == "P":
        return Image.new("RGB", (8, 8), (128,) * 3).quantize(2)
    given = {"1": 1, "F": 128.0, "CMYK": (0, 0, 0, 127), "LAB": (137, 128, 128), "HSV": (0, 0, 128)}
    bands = Image.new(mode, (1, 1)).getbands()
    if "A" in bands:
        return Image.merge(mode, [Image.new("L", (8, 8), 255 if band == "A" else 128) for band in bands])
    wide = 0x8080 if mode.startswith("I") else 128
    return Image.new(mode, (8, 8), given.get(mode, wide if len(bands) == 1 else (128,) * len(bands)))


@pytest.mark.filterwarnings("ignore:Saving I mode images as PNG is deprecated:DeprecationWarning")
@pytest.mark.parametrize("kind", FORMATS)
@pytest.mark.parametrize("mode", MODES)
def test_images_that_pillow_writes_are_right_or_refused(write, mode, kind):
    """Other formats than PNG and JPEG are refused; what cannot be written is no case."""
    try:
        path = write(encoded(mid_grey(mode), kind))
    except (OSError, ValueError, KeyError, TypeError):
        pytest.skip(f"Pillow does not write {mode} as {kind}")
    if kind not in ("PNG", "JPEG"):
        with pytest.raises(DatasetError, match="cannot be identified as PNG or JPEG") as caught:
            open_texture(path)
        assert caught.value.file == str(path)
        return
    found = np.asarray(open_texture(path)).astype(int)
    assert (found[..., 3] == 255).all()
    assert abs(found[..., :3] - (255 if mode == "1" else 128)).max() <= 2


def test_colour_profiles_are_converted_to_srgb(write):
    """A profile whose red and blue primaries are swapped turns red into blue; one of sRGB changes nothing."""
    image = Image.new("RGB", (2, 2), (200, 100, 30))
    plain = ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes()
    assert pixels(write(encoded(image, icc_profile=plain)))[0] == (200, 100, 30, 255)
    swapped = bytearray(plain)
    red, blue = swapped.index(b"rXYZ"), swapped.index(b"bXYZ")
    swapped[red : red + 4], swapped[blue : blue + 4] = b"bXYZ", b"rXYZ"
    swapped = bytes(swapped).replace(b"s\0R\0G\0B", b"o\0t\0h\0r").replace(b"sRGB", b"othr")
    found = pixels(write(encoded(image, icc_profile=swapped)))[0]
    assert abs(np.array(found) - (30, 100, 200, 255)).max() <= 3
    rgba = np.full((2, 2, 4), (200, 100, 30, 7), np.uint8)
    assert pixels(write(encoded(Image.fromarray(rgba), icc_profile=swapped)))[0][3] == 7
    with pytest.raises(DatasetError, match="its colour profile is for RGB, its pixels are CMYK"):
        open_texture(write(encoded(Image.new("CMYK", (2, 2)), "JPEG", icc_profile=plain)))


def test_cmyk_is_stored_inverted_only_with_the_marker_of_adobe(write):
    inverted = encoded(Image.new("CMYK", (16, 16), (0, 255, 255, 0)), "JPEG")  # Pillow writes marker and polarity
    plain = encoded(Image.new("CMYK", (16, 16), (255, 0, 0, 255)), "JPEG")
    start = plain.index(b"\xff\xee")
    plain = plain[:start] + plain[start + 16 :]  # a marker has two bytes, and Adobe's 14 behind it
    assert b"Adobe" not in plain
    for data in (inverted, plain):
        assert abs(np.array(pixels(write(data))[0]) - (255, 0, 0, 255)).max() <= 3


@pytest.mark.parametrize("kind", ["PNG", "JPEG"])
@pytest.mark.parametrize("orientation", range(1, 9))
def test_exif_orientation_is_applied(write, kind, orientation):
    marks = np.zeros((32, 16, 3), np.uint8)
    marks[:16, :8] = 255  # white in the upper left
    upright = Image.fromarray(marks)
    undo = [None, 0, 3, 1, 5, 2, 6, 4][orientation - 1]
    stored = upright if undo is None else upright.transpose(Image.Transpose(undo))
    exif = Image.Exif()
    exif[0x0112] = orientation
    found = np.asarray(open_texture(write(encoded(stored, kind, exif=exif))))[..., 0]
    assert found.shape == (32, 16)
    assert found[4, 2] > 240
    assert max(found[28, 2], found[4, 13], found[28, 13]) < 15


def test_broken_metadata_is_ignored(write):
    data = encoded(Image.new("RGB", (4, 4), (9, 99, 9)), exif=b"Exif\0\0nothing of the kind")
    assert pixels(write(data))[0] == (9, 99, 9, 255)


def test_the_first_frame_of_an_animation_is_read(write):
    frames = [Image.new("RGB", (4, 4), color) for color in ((255, 0, 0), (0, 255, 0))]
    path = write(encoded(frames[0], save_all=True, append_images=frames[1:]))
    assert set(pixels(path)) == {(255, 0, 0, 255)}


def test_resizing_keeps_colours_beside_holes(write):
    """Green with a yellow or black hole: no texel is darker, whatever the colour under alpha 0."""
    for color in ((220, 210, 50), (0, 0, 0)):
        image = np.full((60, 60, 4), (30, 200, 40, 255), np.uint8)
        image[20:50, 10:40] = *color, 0
        found = read_texture(write(encoded(Image.fromarray(image))), 16, "lanczos")
        assert abs(found[..., :3].astype(int) - (30, 200, 40)).max() <= 2
        assert (found[..., 3].min(), found[..., 3].max()) == (0, 255)


def test_colours_of_an_image_that_is_all_hole_are_kept(write):
    image = np.full((8, 8, 4), (30, 200, 40, 0), np.uint8)
    np.testing.assert_array_equal(read_texture(write(encoded(Image.fromarray(image))), 4)[0, 0], (30, 200, 40, 0))


@pytest.mark.parametrize("colors", [1, 2, 256, 257])
def test_images_of_few_colors_are_written_with_a_palette(colors):
    rng = np.random.default_rng(colors)
    palette = np.unique(rng.integers(0, 256, (4 * colors, 3)), axis=0)[:colors].astype(np.uint8)
    image = palette[np.arange(64 * 64).reshape(64, 64) % colors]
    data = encode_png(image)
    assert Image.open(io.BytesIO(data)).mode == ("P" if colors <= 256 else "RGB")
    np.testing.assert_array_equal(decode_image(data), image)
