"""Lights of `KHR_lights_punctual` in a glTF document, as lights of a house."""

from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import root_scalar

from home_mjx.core.color import encode_srgb
from home_mjx.datasets.gltf.decode.container import GltfDocument
from home_mjx.datasets.gltf.decode.scene import Matrix, visit_nodes
from home_mjx.datasets.gltf.scene_lights import MAX_LIGHTS, TOO_MANY, SceneLight, to_vector
from home_mjx.datasets.suncg.formats.json_value import JsonValue
from home_mjx.schema.house import Light
from home_mjx.schema.lighting import LUMENS_PER_WATT

PUNCTUAL = "KHR_lights_punctual"
MAX_CANDELA = 1e7  # [cd]
SPOT_ANGLE = np.pi / 4  # [rad], outer angle of spots that state none
MAX_EXPONENT = 500.0  # maximum exponent of the cosine of spots


@dataclass
class LightReader:
    """Reader of a document's lights.

    Attributes:
        document: The document.
        notes: Elements with the reason why they are not kept.
    """

    document: GltfDocument
    notes: dict[str, str] = field(default_factory=dict)

    def read(self, frame: Matrix) -> list[SceneLight]:
        """Return the point lights and spots of the scene; candelas are `LUMENS_PER_WATT` times W/sr of the records.

        Args:
            frame: House from the document's frame.

        Raises:
            DatasetError: An index or a value is out of range, or lights are more than `MAX_LIGHTS`.
        """
        stated = _extension(self.document.root)
        listed = stated.member("lights") if stated.has_value else stated
        lights = listed.entries() if listed.has_value else []
        if len(lights) > MAX_LIGHTS:
            raise listed.error(TOO_MANY, "Remove lights.")
        found = ((value, self._light(lights, index, matrix)) for value, index, matrix in self._nodes(frame))
        return [SceneLight(value.element, light) for value, light in found if light is not None]

    def _nodes(self, frame: Matrix) -> Iterator[tuple[JsonValue, JsonValue, Matrix]]:
        """Yield the nodes that name a light, its index, and house from node; raise beyond `MAX_LIGHTS` nodes."""
        count = 0
        for value, chain in visit_nodes(self.document, {}, frame):
            own = _extension(value)
            count += own.has_value
            if count > MAX_LIGHTS:
                raise value.error(TOO_MANY, "Remove lights.")
            if own.has_value:
                yield value, own.member("light"), chain[-1].matrix

    def _light(self, lights: list[JsonValue], index: JsonValue, matrix: Matrix) -> Light | None:
        """Return the light that a node at a place names; None, with a note, for directional and dark ones."""
        if not 0 <= index.integer() < len(lights):
            raise index.error(f"expected an index into the {len(lights)} `lights`, got {index.integer()}")
        value = lights[index.integer()]
        kind, color, stated = value.member("type"), value.member("color"), value.member("intensity")
        if kind.text() not in ("point", "spot", "directional"):
            raise kind.error(f"expected point, spot or directional, got `{kind.text()[:20]}`")
        linear = np.clip(color.vector(3) if color.has_value else np.ones(3), 0, 1)
        candela = (stated.number() if stated.has_value else 1.0) * float(linear.max())
        if kind.text() == "directional" or candela <= 0:
            self.notes[value.element] = "directional or dark light is not kept"
            return None
        shade = to_vector(encode_srgb(linear / linear.max()))
        strength = min(candela, MAX_CANDELA) / LUMENS_PER_WATT  # [W/sr]
        place = to_vector(matrix[:3, 3])
        if kind.text() == "point":
            return Light("point", 4 * np.pi * strength, shade, place)
        aim = -matrix[:3, 2] / np.linalg.norm(matrix[:3, 2])
        inner, outer = _cones(value.member("spot"))
        share = 1 - np.cos(inner) + (np.cos(inner) - np.cos(outer)) / 3
        dropoff = _exponent(float(np.cos(outer)), float(share))
        return Light("spot", float(2 * np.pi * share * strength), shade, place, to_vector(aim), outer, dropoff=dropoff)


def _cones(spot: JsonValue) -> tuple[float, float]:
    """Return the inner and outer angle of a spot [rad]."""
    low, high = (spot.member(key) if spot.has_value else spot for key in ("innerConeAngle", "outerConeAngle"))
    outer = high.number() if high.has_value else SPOT_ANGLE
    inner = low.number() if low.has_value else 0.0
    if not 0 < outer <= np.pi / 2 + 1e-6:
        raise high.error(f"expected an angle above 0 and up to pi/2, got {outer:g}")
    if not 0 <= inner <= outer:  # some exporters write equal angles for a sharp edge
        raise low.error(f"expected an angle from 0 to that of the outer cone, got {inner:g}")
    return min(inner, np.pi / 2), min(outer, np.pi / 2)


def _exponent(cosine: float, share: float) -> float:
    """Return the exponent of the cosine whose integral down to `cosine` is `share`; 0 to `MAX_EXPONENT`."""

    def excess(exponent: float) -> float:
        """Return how much the integral of an exponent exceeds the share."""
        return (1 - cosine ** (exponent + 1)) / (exponent + 1) - share

    if excess(0.0) <= 1e-9 or excess(MAX_EXPONENT) >= 0:
        return 0.0 if excess(0.0) <= 1e-9 else MAX_EXPONENT
    return float(root_scalar(excess, bracket=(0.0, MAX_EXPONENT)).root)


def _extension(value: JsonValue) -> JsonValue:
    """Return the entry of `KHR_lights_punctual`; null if there is none."""
    extensions = value.member("extensions")
    return extensions.member(PUNCTUAL) if extensions.has_value else extensions
