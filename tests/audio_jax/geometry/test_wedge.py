"""Diffraction coefficients against exact solutions."""

import jax.numpy as jnp
import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import hankel1, modfresnelm

from home_mjx.audio_jax.geometry.wedge import WedgeGeometry, diffracted_pressure, second_edge_factor, transition

QUARTER = np.exp(0.25j * np.pi)


def integrate(function, stop) -> complex:
    parts = (quad(lambda t, p=p: getattr(function(t), p), 0, stop, limit=200)[0] for p in ("real", "imag"))
    return complex(*parts)


def half_plane(k, near, far, face, there) -> complex:
    """Macdonald's exact field of a point source beside a rigid half-plane, all in one plane across the edge.

    Per image: the integral of H1(kR + t²) / sqrt(t² + 2kR) up to ± sqrt(k (R1 - R)), R1 over the edge, taken along
    lines on which it falls off (Bowman, Senior and Uslenghi, 1969).
    """

    def image(angle) -> complex:
        distance = np.sqrt(near**2 + far**2 - 2 * near * far * np.cos(angle))
        end = np.sqrt(k * max(near + far - distance, 0.0)) * np.sign(np.cos(angle / 2))

        def beyond(start) -> complex:
            def along(t: float) -> complex:
                square = (start + t * QUARTER) ** 2
                return hankel1(1, k * distance + square) / np.sqrt(square + 2 * k * distance) * QUARTER

            return integrate(along, 12)

        whole = 2 * beyond(0.0)
        part = whole - beyond(end) if end >= 0 else beyond(-end)
        return np.exp(1j * k * distance) / distance * part / whole

    return image(there - face) + image(there + face)


def one(*fields) -> WedgeGeometry:
    return WedgeGeometry(*(jnp.full(1, x, jnp.float32) for x in fields))


def gain(bend, k) -> complex:
    return complex(diffracted_pressure(bend, jnp.full(1, k, jnp.float32))[0, 0])


@pytest.mark.parametrize("frequency", [125, 1000, 4000])
@pytest.mark.parametrize("turn", [0.05, 5, 15, 30, 55])
@pytest.mark.parametrize(("near", "far", "face"), [(1.5, 1.5, 60), (0.8, 3.0, 80)])
def test_shadow_of_a_half_plane_equals_the_exact_solution(frequency, turn, near, far, face):
    k = 2 * np.pi * frequency / 343.2
    there = np.radians(face + 180 + turn)
    exact = half_plane(k, near, far, np.radians(face), there) * (near + far) * np.exp(-1j * k * (near + far))
    ours = gain(one(near, far, np.radians(face), np.radians(turn), 2, 1), k)
    assert 20 * np.log10(abs(ours) / abs(exact)) == pytest.approx(0, abs=0.4)
    assert abs(np.angle(ours / np.conj(exact))) < 0.1  # theirs has the phase of exp(+ i k r)


@pytest.mark.parametrize(("turn", "expected"), [(0.01, -5.2), (15, -9.2), (30, -12.5), (60, -17.2)])
def test_the_published_table(turn, expected):
    """1 kHz, source 60 degrees from the screen, 1.5 m each: level re the straight path of a free field."""
    straight = 2 * 1.5 * np.cos(np.radians(turn) / 2)
    ours = abs(gain(one(1.5, 1.5, np.pi / 3, np.radians(turn), 2, 1), 2 * np.pi * 1000 / 343.2)) * straight / 3
    assert 20 * np.log10(ours) == pytest.approx(expected, abs=0.1)


@pytest.mark.parametrize("wedge", [1.5, 2.0])
@pytest.mark.parametrize("face", [30, 60, 85])
def test_the_sum_is_smooth_across_the_shadow_boundary(wedge, face):
    k = 2 * np.pi * 2000 / 343.2
    for angle in np.radians([0.02, 1.0]):
        ends = [one(1.5, 1.0, np.radians(face), side * angle, wedge, 1) for side in (-1, 1)]
        detour = 2.5 - np.sqrt(1.5**2 + 1 + 2 * 1.5 * np.cos(angle))
        straight = np.exp(1j * k * detour) * 2.5 / (2.5 - detour)
        lit, dark = straight + gain(ends[0], k), gain(ends[1], k)
        assert abs(lit - dark) < 0.7 * np.sin(angle) * np.sqrt(k) + 0.01


def test_source_and_listener_change_places():
    """Measured from the other face and with the legs exchanged, a bend is the same."""
    k, wedge = 2 * np.pi * 500 / 343.2, 1.5
    face, turn = np.radians(50), np.radians(20)
    other = wedge * np.pi - (np.pi + turn + face)
    there, back = one(0.7, 2.5, face, turn, wedge, 0.9), one(2.5, 0.7, other, turn, wedge, 0.9)
    assert gain(there, k) == pytest.approx(gain(back, k), rel=1e-4)


@pytest.mark.parametrize("x", [1e-4, 0.01, 0.3, 0.79, 0.81, 2.0, 10.0, 300.0])
def test_transition_function(x):
    """2 i sqrt(x) exp(i x) times the modified Fresnel integral of sqrt(x)."""
    exact = 2j * np.sqrt(x) * np.exp(1j * x) * modfresnelm(np.sqrt(x))[0]
    assert abs(complex(transition(jnp.float32(x))) - exact) < 0.01


def test_a_second_edge_takes_more_the_more_it_turns():
    taken = second_edge_factor(jnp.radians(jnp.float32([0, 10, 40, 80])), jnp.ones(4), jnp.full(1, 20.0))[:, 0]
    assert float(taken[0]) == pytest.approx(1, abs=1e-3)
    assert np.all(np.diff(taken) < 0)
