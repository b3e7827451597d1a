"""Images as layers: colours and alpha arrive; what is broken or too large is refused with its file's name."""

import struct
import zlib

import numpy as np
import pytest
from PIL import Image, PngImagePlugin
from png_files import encoded, png_of

from home_mjx.bank.packing.texture_layers import load_textures
from home_mjx.core import images
from home_mjx.core.images import open_texture
from home_mjx.errors import DatasetError


def png_of_size(width, height, data=b""):
    """A PNG whose header claims a size, whatever its pixels."""
    chunks = [(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)), (b"IDAT", data), (b"IEND", b"")]
    return png_of(chunks)


@pytest.fixture
def write(tmp_path):
    def to_file(data, name="a.png"):
        path = tmp_path / name
        path.write_bytes(data)
        return path

    return to_file


def refused(path):
    with pytest.raises(DatasetError) as caught:
        open_texture(path)
    assert caught.value.file == str(path)
    assert caught.value.hint
    return caught.value.message


def test_layers_are_srgb_with_alpha_and_the_first_row_on_top(write):
    pixels = np.zeros((4, 4, 4), np.uint8)
    pixels[:2], pixels[2:] = (200, 10, 30, 255), (0, 0, 255, 128)
    path = write(encoded(Image.fromarray(pixels)))
    layers = load_textures([str(path)], size=4)
    np.testing.assert_array_equal(layers[0, :16].reshape(4, 4, 4), pixels)


@pytest.mark.parametrize("mode", ["L", "LA", "P", "RGB", "1", "CMYK"])
def test_modes(write, mode):
    image = Image.new("RGB", (3, 2), (255, 255, 255)).convert(mode)
    path = write(encoded(image, "JPEG" if mode == "CMYK" else "PNG"))
    assert (open_texture(path).mode, open_texture(path).getpixel((0, 0))) == ("RGBA", (255, 255, 255, 255))


@pytest.mark.parametrize("kind", ["PNG", "JPEG"])
def test_truncated_images(write, kind):
    rng = np.random.default_rng(0)
    data = encoded(Image.fromarray(rng.integers(0, 255, (64, 64, 3), np.uint8)), kind)
    for end in (0, 1, 10, len(data) // 4, len(data) // 2, len(data) - 200):
        assert "cannot read texture" in refused(write(data[:end]))


@pytest.mark.parametrize(("width", "height"), [(60_000, 60_000), (10_000, 9_000), (6_000, 6_000), (2**31 - 1, 1)])
@pytest.mark.filterwarnings("ignore::PIL.Image.DecompressionBombWarning")
def test_images_that_claim_too_many_pixels(write, width, height):
    message = refused(write(png_of_size(width, height, zlib.compress(bytes(1000)))))
    assert "cannot read texture" in message


def test_size_is_checked_before_pixels_are_decoded(write, monkeypatch):
    path = write(encoded(Image.new("RGB", (20, 20))))
    monkeypatch.setattr(images, "MAX_PIXELS", 399)
    monkeypatch.setattr(PngImagePlugin.PngImageFile, "load", lambda self: pytest.fail("pixels were decoded"))
    assert refused(path) == "cannot read texture: it has 20 x 20 pixels, at most 399 are decoded"


def test_compressed_text_that_unpacks_to_gigabytes(write):
    """Pillow has its own limit for chunks of text: the error becomes one of ours."""
    info = PngImagePlugin.PngInfo()
    info.add_text("a", "x" * (1 << 23), zip=True)
    assert "cannot read texture" in refused(write(encoded(Image.new("RGB", (2, 2)), pnginfo=info)))


@pytest.mark.parametrize("kind", ["BMP", "GIF", "TIFF", "PPM"])
def test_other_kinds_of_images(write, kind):
    assert "cannot be identified as PNG or JPEG" in refused(write(encoded(Image.new("RGB", (2, 2)), kind)))


def test_postscript_is_never_run(write):
    assert "cannot be identified" in refused(write(b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\nshowpage\n"))


def test_missing_files_and_folders(tmp_path, write):
    assert refused(tmp_path / "nothing.png") == "file is missing"
    assert "not a regular file" in refused(tmp_path)
