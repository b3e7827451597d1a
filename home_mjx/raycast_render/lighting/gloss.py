"""Specular reflection of surfaces: GGX with Fresnel's increase towards grazing incidence."""

import math

import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.core.pytree import Pytree
from home_mjx.raycast_render.scene.vec import Vec

MAX_EDGE = 50.0  # reflectances below 1/50, which no substance has, stand for shade and do not reach 1 at grazing angles


class ShadingPoint(Pytree):
    """Shading points of rays of any shape."""

    pos: Vec  # [m]
    normal: Vec  # unit, of the triangle, facing the ray
    shading: Vec  # unit, smooth
    view: Vec  # unit, towards the viewer
    shininess: Float[Array, "*rays"]  # Blinn-Phong exponent, which `roughness` converts
    instance: Int[Array, "*rays"]  # -1 on a miss
    room: Int[Array, "*rays"]
    edge: Float[Array, "*#rays"] | float = 1.0  # specular reflectance at grazing incidence over that at normal


def roughness(shininess: Float[Array, "*rays"]) -> Float[Array, "*rays"]:
    """Return the width alpha of GGX, the square of glTF's roughness, of a Blinn-Phong exponent n: sqrt(2 / (n + 2)).

    Source: B. Karis, "Specular BRDF reference", 2013.

    Example:
        >>> float(roughness(jnp.float32(6.0)))
        0.5
    """
    return jnp.sqrt(2 / (shininess + 2))


def edge_factor(specular: Vec) -> Float[Array, "*rays"]:
    """Return the reflectance at grazing incidence over that at normal incidence, of the largest channel `specular`."""
    top = jnp.maximum(jnp.maximum(specular.x, specular.y), specular.z)
    return 1 / jnp.maximum(top, 1 / MAX_EDGE)


def ggx(point: ShadingPoint, toward: Vec) -> Float[Array, "*rays"]:
    """Compute the specular BRDF [1/sr] over the reflectance at normal incidence, for light from the unit `toward`.

    Sources: B. Walter et al., "Microfacet models for refraction through rough surfaces", EGSR 2007; E. Hammon, "PBR
    diffuse lighting for GGX + Smith microsurfaces", GDC 2017, for the masking; C. Schlick, "An inexpensive BRDF model
    for physically-based rendering", 1994, for Fresnel's factor.
    """
    half, alpha = (toward + point.view).unit(), roughness(point.shininess)
    up = jnp.clip(half.dot(point.shading), 0.0, 1.0)
    light, view = (jnp.clip(v.dot(point.shading), 1e-3, 1.0) for v in (toward, point.view))
    spread = 1 - up * up * (1 - alpha * alpha)
    density = alpha * alpha / (math.pi * spread * spread)
    both = 2 * light * view
    visible = 0.5 / (both + alpha * (light + view - both))
    return density * visible * _fresnel(point.edge, half.dot(toward))


def _fresnel(edge: Float[Array, "*#rays"] | float, cosine: Float[Array, "*rays"]) -> Float[Array, "*rays"]:
    """Return the reflectance at a cosine of incidence over that at normal incidence."""
    flat = 1 - jnp.clip(cosine, 0.0, 1.0)
    square = flat * flat
    return 1 + (edge - 1) * (square * square * flat)


def reflect_view(point: ShadingPoint) -> Vec:
    """Return the unit direction whose light a mirror in the place of each point would send to the viewer."""
    return point.shading * (2 * point.shading.dot(point.view)) - point.view


def uniform_gloss(point: ShadingPoint) -> Float[Array, "*rays"]:
    """Return the reflectance in light of equal radiance from everywhere, over that at normal incidence.

    The part for reflectances of 1 is a fit of our own, within 0.1 of the integral of the exact BRDF for cosines of view
    from 0.3 on. Source of the other: B. Karis, "Physically based shading on mobile", 2014.
    """
    alpha, view = roughness(point.shininess), jnp.clip(point.shading.dot(point.view), 0.0, 1.0)
    rough = jnp.sqrt(alpha)
    mirror, least = 1 - rough, 0.0425 - 0.0275 * rough
    grazing = 1.04 * (jnp.minimum(mirror * mirror, jnp.exp2(-9.28 * view)) * mirror + least) - 0.04 + 0.022 * rough
    return 1 - 0.69 * alpha * jnp.sqrt(rough) + jnp.maximum(grazing, 0.0) * (point.edge - 1)
