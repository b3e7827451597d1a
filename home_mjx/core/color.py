"""Colour spaces (sRGB, linear light, CIELAB) and the perceived difference of two colours."""

import numpy as np
from jaxtyping import Float

# Linear sRGB to CIE XYZ (IEC 61966-2-1); the row sums are the white point D65.
_XYZ = np.array(
    [[0.4124564, 0.3575761, 0.1804375], [0.2126729, 0.7151522, 0.0721750], [0.0193339, 0.1191920, 0.9503041]]
)
_WHITE = _XYZ.sum(axis=1)
_KNEE = 6 / 29  # CIELAB: the cube root becomes linear below `_KNEE**3`


def decode_srgb(color: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n"]:
    """Convert sRGB to linear light, both in 0..1 (IEC 61966-2-1); values outside are not clipped."""
    return np.where(color <= 0.04045, color / 12.92, ((color + 0.055) / 1.055) ** 2.4)


def encode_srgb(linear: Float[np.ndarray, "*n"]) -> Float[np.ndarray, "*n"]:
    """Convert linear light to sRGB, both in 0..1 (IEC 61966-2-1); values outside are not clipped."""
    curve = 1.055 * np.maximum(linear, 0.0031308) ** (1 / 2.4) - 0.055
    return np.where(linear <= 0.0031308, 12.92 * linear, curve)


def linear_to_lab(color: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n 3"]:
    """Convert linear sRGB to CIELAB (L 0..100, a, b; white point D65) by CIE 15:2004.

    Example:
        >>> np.abs(linear_to_lab(np.ones((1, 3))).round(3))
        array([[100.,   0.,   0.]])
    """
    t = color @ _XYZ.T / _WHITE
    f = np.where(t > _KNEE**3, np.cbrt(t), t / (3 * _KNEE**2) + 4 / 29)
    x, y, z = np.moveaxis(f, -1, 0)
    return np.stack([116 * y - 16, 500 * (x - y), 200 * (y - z)], axis=-1)


def srgb_to_lab(color: Float[np.ndarray, "*n 3"]) -> Float[np.ndarray, "*n 3"]:
    """Convert gamma-encoded sRGB colours in 0..1 to CIELAB; see `linear_to_lab`."""
    return linear_to_lab(decode_srgb(color))


def ciede2000(a: Float[np.ndarray, "*n 3"], b: Float[np.ndarray, "*m 3"]) -> Float[np.ndarray, "..."]:
    """Compute the difference CIEDE2000 of CIELAB colours; leading axes, at least one, are broadcast as in NumPy.

    Formula and symbols: Sharma, Wu, Dalal, "The CIEDE2000 Color-Difference Formula", Color Research & Application 30
    (2005), equations 2 to 22, with all three parametric factors equal to 1.

    Example:
        >>> ciede2000(np.array([[50.0, 2.5, 0.0]]), np.array([[73.0, 25.0, -18.0], [50.0, 0.0, -2.5]])).round(4)
        array([27.1492,  4.3065])
    """
    a, b = np.broadcast_arrays(a, b)
    stretch = 1.5 - 0.5 * _saturation((np.hypot(a[..., 1], a[..., 2]) + np.hypot(b[..., 1], b[..., 2])) / 2)
    chroma_a, hue_a = _polar(a[..., 1] * stretch, a[..., 2])
    chroma_b, hue_b = _polar(b[..., 1] * stretch, b[..., 2])
    gray = chroma_a * chroma_b == 0
    turn = hue_b - hue_a  # [deg]
    turn = np.where(gray, 0, np.where(abs(turn) > 180, turn - 360 * np.sign(turn), turn))
    hue = np.where(gray, hue_a + hue_b, hue_a + turn / 2)
    lightness, chroma = (a[..., 0] + b[..., 0]) / 2 - 50, (chroma_a + chroma_b) / 2
    dl = (b[..., 0] - a[..., 0]) / (1 + 0.015 * lightness**2 / np.sqrt(20 + lightness**2))
    dc = (chroma_b - chroma_a) / (1 + 0.045 * chroma)
    dh = 2 * np.sqrt(chroma_a * chroma_b) * _sin(turn / 2) / (1 + 0.015 * chroma * _hue_weight(hue))
    rotation = -_sin(60 * np.exp(-(((hue % 360 - 275) / 25) ** 2))) * 2 * _saturation(chroma)
    return np.sqrt(dl**2 + dc**2 + dh**2 + rotation * dc * dh)


def _saturation(chroma: np.ndarray) -> np.ndarray:
    """Evaluate sqrt(C^7 / (C^7 + 25^7)) of the CIEDE2000 formula."""
    return np.sqrt(chroma**7 / (chroma**7 + 25.0**7))


def _polar(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return chroma and hue angle [deg], in 0..360, of the CIELAB components a and b."""
    return np.hypot(a, b), np.rad2deg(np.arctan2(b, a)) % 360


def _hue_weight(hue: np.ndarray) -> np.ndarray:
    """Evaluate T of the CIEDE2000 formula at a mean hue [deg]."""
    return 1 - 0.17 * _sin(hue + 60) + 0.24 * _sin(2 * hue + 90) + 0.32 * _sin(3 * hue + 96) - 0.20 * _sin(4 * hue + 27)


def _sin(degrees: np.ndarray) -> np.ndarray:
    """Return the sine of an angle [deg]."""
    return np.sin(np.deg2rad(degrees))
