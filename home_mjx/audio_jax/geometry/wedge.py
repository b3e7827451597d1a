"""Diffraction by rigid wedges: the uniform theory of Kouyoumjian and Pathak, and Pierce's second edge."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float

NEAR_BOUNDARY = 1e-4  # [rad], within which an angle counts as this far from a shadow boundary
FADE = np.pi / 3  # [rad], past the reflection boundary, over which the reflected wave's share comes in


class Bend(NamedTuple):
    """How sound bends around edges. Angles are seen along the edge, distances are across it."""

    near: Float[Array, " e"]  # [m], from the source to the edge
    far: Float[Array, " e"]  # [m], from the edge to the listener
    face: Float[Array, " e"]  # [rad], from the wedge's face to the source
    turn: Float[Array, " e"]  # [rad], by which the path turns into the shadow; negative where the straight path is free
    wedge: Float[Array, " e"]  # exterior angle in units of pi: 2 half-plane, 1.5 right-angled edge
    slope: Float[Array, " e"]  # sine of the angle between path and edge


def transition(x: Float[Array, "*n"]) -> Complex[Array, "*n"]:
    """The transition function 2 i sqrt(x) exp(i x) ∫ exp(-i t²) dt from sqrt(x) on, within 0.007 of it.

    Args:
        x: Detour in radians, >= 0.

    Returns:
        0 at x = 0, towards 1 far from the shadow boundary.

    Source: Kouyoumjian and Pathak, Proc. IEEE 62 (1974); Kawai's approximation as in Tsingos et al., SIGGRAPH 2001.

    Example:
        >>> float(abs(transition(jnp.float32(100.0))).round(2))
        1.0
    """
    root = jnp.sqrt(x)
    low = jnp.sqrt(jnp.pi * x) * (1 - root / (0.7 * root + 1.2))
    high = 1 - 0.8 / (x + 1.25) ** 2
    angle = jnp.pi / 4 * (1 - jnp.sqrt(x / (x + 1.4)))
    size = jnp.where(x < 0.8, low, high)
    return jax.lax.complex(size * jnp.cos(angle), size * jnp.sin(angle))


def diffracted(bend: Bend, wavenumber: Float[Array, " f"]) -> Complex[Array, "e f"]:
    """Pressure diffracted by rigid wedges re the free field after the same length of path.

    In the shadow it is all there is; where the straight path is free it comes on top of that, and the sum is smooth
    across the shadow boundary. The part that belongs to the wave reflected by a face fades out where that wave itself
    is heard, which image sources render.

    Args:
        bend: Edges.
        wavenumber: 2 pi f / c [1/m].

    Returns:
        Amplitude; its phase is that of exp(-i k r).

    Source: Kouyoumjian and Pathak, A uniform geometrical theory of diffraction, Proc. IEEE 62 (1974).

    Example:
        >>> far = jnp.full(1, 1.5)
        >>> edge = Bend(far, far, jnp.full(1, np.pi / 3), jnp.full(1, np.pi / 6), jnp.full(1, 2.0), jnp.ones(1))
        >>> gain = abs(diffracted(edge, jnp.full(1, 2 * np.pi * 1000 / 343.2)))
        >>> round(float(20 * jnp.log10(gain[0, 0])), 1)  # 30 degrees into the shadow at 1 kHz [dB]
        -12.2
    """
    wedge, harmonic = bend.wedge, bend.near * bend.far / (bend.near + bend.far)
    length = harmonic * bend.slope  # s r sin² / (s + r) with s and r along the path
    between = jnp.pi + bend.turn
    added = between + 2 * bend.face
    straight = _term(-bend.turn, wedge, length, wavenumber) + _term(jnp.pi + between, wedge, length, wavenumber)
    mirrored = _term(jnp.pi - added, wedge, length, wavenumber) + _term(jnp.pi + added, wedge, length, wavenumber)
    outside = jnp.minimum(added - jnp.pi, (2 * wedge - 1) * jnp.pi - added)  # of both faces' reflections
    share = jnp.clip(outside / FADE, 0.0, 1.0)[:, None]
    scale = jnp.sqrt(2 * jnp.pi * wavenumber)[None] * (2 * wedge * jnp.sqrt(bend.slope * harmonic))[:, None]
    # in the phase of -exp(-i pi / 4)
    return (straight + share.astype(jnp.complex64) * mirrored) * jax.lax.complex(
        -np.sqrt(0.5) / scale, np.sqrt(0.5) / scale
    )


def _term(
    past: Float[Array, " e"], wedge: Float[Array, " e"], length: Float[Array, " e"], wavenumber: Float[Array, " f"]
) -> Complex[Array, "e f"]:
    """cot(ε / 2n) F(k L a), with ε the angle past the nearest boundary and a = 2 sin²(ε / 2)."""
    period = 2 * jnp.pi * wedge
    past = past - period * jnp.round(past / period)
    past = jnp.where(past < 0, jnp.minimum(past, -NEAR_BOUNDARY), jnp.maximum(past, NEAR_BOUNDARY))
    detour = (2 * length * jnp.sin(past / 2) ** 2)[:, None] * wavenumber[None]
    return transition(detour) * (1 / jnp.tan(past / (2 * wedge)))[:, None].astype(jnp.complex64)


def second_edge(
    turn: Float[Array, " e"], reach: Float[Array, " e"], wavenumber: Float[Array, " f"]
) -> Float[Array, "e f"]:
    """Factor on pressure that a second edge, parallel to the first, takes from a path that turns at both.

    Args:
        turn: At the second edge, the smaller turn [rad]; 0 takes nothing.
        reach: w (w + s + r) / ((w + s) (w + r)) times 2 r (w + s) / (w + s + r), the edge's own distances, w between
            the edges [m].
        wavenumber: [1/m].

    Source: Pierce, Diffraction of sound around corners and over wide barriers, J. Acoust. Soc. Am. 55 (1974), whose
    factor this is; auxiliary Fresnel functions after Abramowitz and Stegun 7.3.32 and 7.3.33.

    Example:
        >>> float(second_edge(jnp.zeros(1), jnp.ones(1), jnp.ones(1))[0, 0].round(3))
        1.0
    """
    power = 2 / 3
    bend = (np.cos(power * np.pi) - jnp.cos(power * (np.pi + turn))) / (power * np.sin(power * np.pi))
    x = bend[:, None] * jnp.sqrt(reach[:, None] * wavenumber[None] / (2 * jnp.pi))
    f = (1 + 0.926 * x) / (2 + 1.792 * x + 3.104 * x**2)
    g = 1 / (2 + 4.142 * x + 3.492 * x**2 + 6.670 * x**3)
    return jnp.sqrt(2 * (f**2 + g**2))
