"""Diffraction by rigid wedges: the uniform theory of Kouyoumjian and Pathak, and Pierce's double-edge factor."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float

MIN_BOUNDARY_ANGLE = 1e-4  # [rad], minimum angle from a shadow boundary; smaller ones are clamped to it
REFLECTION_FADE_ANGLE = np.pi / 3  # [rad], beyond the reflection boundary; there the reflected wave's term fades in


class WedgeGeometry(NamedTuple):
    """Geometry of diffraction at edges. Angles are in the plane perpendicular to the edge, distances as well."""

    source_distance: Float[Array, " e"]  # [m], from the source to the edge
    listener_distance: Float[Array, " e"]  # [m], from the edge to the listener
    face_angle: Float[Array, " e"]  # [rad], from the wedge's face to the source
    # [rad], diffraction angle into the shadow; negative where the straight path is free
    shadow_angle: Float[Array, " e"]
    exterior_angle: Float[Array, " e"]  # exterior angle in units of pi: 2 half-plane, 1.5 right-angled edge
    sin_incidence: Float[Array, " e"]  # sine of the angle between path and edge


def transition(x: Float[Array, "*n"]) -> Complex[Array, "*n"]:
    """Approximate the transition function 2 i sqrt(x) exp(i x) ∫ exp(-i t²) dt, t from sqrt(x) on, within 0.007.

    Args:
        x: Phase of the detour k L a [rad], >= 0.

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


def diffracted_pressure(bend: WedgeGeometry, wavenumber: Float[Array, " f"]) -> Complex[Array, "e f"]:
    """Compute the pressure diffracted by rigid wedges re the free field at the same path length.

    In the shadow it is the total field. Where the straight path is free it adds to that path's field, and the sum is
    continuous across the shadow boundary. The term of the wave reflected by a face fades out where that wave is
    present, because image sources render it.

    Args:
        bend: Edges.
        wavenumber: 2 pi f / c [1/m].

    Returns:
        Complex ratios, in the convention that a wave is exp(-i k r).

    Source: Kouyoumjian and Pathak, A uniform geometrical theory of diffraction, Proc. IEEE 62 (1974).

    Example:
        >>> far = jnp.full(1, 1.5)
        >>> edge = WedgeGeometry(
        ...     far, far, jnp.full(1, np.pi / 3), jnp.full(1, np.pi / 6), jnp.full(1, 2.0), jnp.ones(1)
        ... )
        >>> gain = abs(diffracted_pressure(edge, jnp.full(1, 2 * np.pi * 1000 / 343.2)))
        >>> round(float(20 * jnp.log10(gain[0, 0])), 1)  # 30 degrees into the shadow at 1 kHz [dB]
        -12.2
    """
    wedge, near, far = bend.exterior_angle, bend.source_distance, bend.listener_distance
    harmonic = near * far / (near + far)
    length = harmonic * bend.sin_incidence  # s r sin² / (s + r) with s and r along the path
    between = jnp.pi + bend.shadow_angle
    added = between + 2 * bend.face_angle
    straight = _term(-bend.shadow_angle, wedge, length, wavenumber) + _term(jnp.pi + between, wedge, length, wavenumber)
    mirrored = _term(jnp.pi - added, wedge, length, wavenumber) + _term(jnp.pi + added, wedge, length, wavenumber)
    outside = jnp.minimum(added - jnp.pi, (2 * wedge - 1) * jnp.pi - added)  # angle beyond both reflection boundaries
    share = jnp.clip(outside / REFLECTION_FADE_ANGLE, 0.0, 1.0)[:, None]
    scale = jnp.sqrt(2 * jnp.pi * wavenumber)[None] * (2 * wedge * jnp.sqrt(bend.sin_incidence * harmonic))[:, None]
    # The factor has the phase of -exp(-i pi / 4).
    return (straight + share.astype(jnp.complex64) * mirrored) * jax.lax.complex(
        -np.sqrt(0.5) / scale, np.sqrt(0.5) / scale
    )


def _term(
    past: Float[Array, " e"], wedge: Float[Array, " e"], length: Float[Array, " e"], wavenumber: Float[Array, " f"]
) -> Complex[Array, "e f"]:
    """Evaluate cot(ε / 2n) F(k L a), a = 2 sin²(ε / 2), F = `transition`; ε is `past` [rad] mod 2 π n, n = `wedge`."""
    period = 2 * jnp.pi * wedge
    past = past - period * jnp.round(past / period)
    past = jnp.where(past < 0, jnp.minimum(past, -MIN_BOUNDARY_ANGLE), jnp.maximum(past, MIN_BOUNDARY_ANGLE))
    detour = (2 * length * jnp.sin(past / 2) ** 2)[:, None] * wavenumber[None]
    return transition(detour) * (1 / jnp.tan(past / (2 * wedge)))[:, None].astype(jnp.complex64)


def second_edge_factor(
    turn: Float[Array, " e"], reach: Float[Array, " e"], wavenumber: Float[Array, " f"]
) -> Float[Array, "e f"]:
    """Compute the pressure factor, 0 to 1, of a second edge, parallel to the first, for paths that turn at both.

    Args:
        turn: Turn at the second edge, the smaller of the two [rad]; the factor is 1 at 0.
        reach: 2 w r / (w + r) with w the distance between the edges and r that from the second edge to its end of the
            path [m]. Pierce's form is w (w + s + r) / ((w + s) (w + r)) times 2 r (w + s) / (w + s + r).
        wavenumber: [1/m].

    Source: Pierce, Diffraction of sound around corners and over wide barriers, J. Acoust. Soc. Am. 55 (1974), whose
    factor this is; auxiliary Fresnel functions after Abramowitz and Stegun 7.3.32 and 7.3.33.

    Example:
        >>> float(second_edge_factor(jnp.zeros(1), jnp.ones(1), jnp.ones(1))[0, 0].round(3))
        1.0
    """
    power = 2 / 3
    bend = (np.cos(power * np.pi) - jnp.cos(power * (np.pi + turn))) / (power * np.sin(power * np.pi))
    x = bend[:, None] * jnp.sqrt(reach[:, None] * wavenumber[None] / (2 * jnp.pi))
    f = (1 + 0.926 * x) / (2 + 1.792 * x + 3.104 * x**2)
    g = 1 / (2 + 4.142 * x + 3.492 * x**2 + 6.670 * x**3)
    return jnp.sqrt(2 * (f**2 + g**2))
