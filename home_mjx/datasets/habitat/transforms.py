"""Frames of Habitat: up and front of assets, places of instances with their scales and origins."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.habitat.templates import HabitatTemplate
from home_mjx.datasets.suncg.formats.json_value import MAX_COORDINATE, JsonValue
from home_mjx.geometry.meshes import Z_UP
from home_mjx.geometry.rotations import quat_matrix

Matrix = Float[np.ndarray, "4 4"]
ORIGINS = ("com", "asset_local")
MAX_SCALE = 1e6  # maximum factor of a scale
MIN_VOLUME = 1e-15  # minimum absolute determinant of a transform


@dataclass(frozen=True)
class Placement:
    """Place of an instance in its scene.

    Attributes:
        translation: Position [m].
        rotation: Rotation of column vectors.
        scale: Factors along the axes of the oriented asset.
        is_local: Whether the position is that of the asset's origin, else that of its centre of mass.
    """

    translation: Float[np.ndarray, "3"]
    rotation: Float[np.ndarray, "3 3"]
    scale: Float[np.ndarray, "3"]
    is_local: bool

    @property
    def rigid(self) -> Matrix:
        """Scene from instance, without scale."""
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = self.rotation, self.translation
        return matrix


def read_placement(value: JsonValue, scene_origin: JsonValue) -> Placement:
    """Read the place of an instance; `scene_origin` is the `translation_origin` of its scene.

    Raises:
        DatasetError: A value is not finite, the quaternion has no length, or the origin is unknown.
    """
    place, turn = value.member("translation"), value.member("rotation")
    quaternion = turn.vector(4) if turn.has_value else np.array([1.0, 0, 0, 0])  # w x y z
    if np.linalg.norm(quaternion) < 1e-6:
        raise turn.error("quaternion has no length")
    uniform, axes = value.member("uniform_scale"), value.member("non_uniform_scale")
    scale = axes.vector(3) if axes.has_value else np.ones(3)
    scale = scale * (uniform.coordinate() if uniform.has_value else 1.0)
    own = value.member("translation_origin")
    origin = own if own.has_value else scene_origin
    name = origin.text().lower() if origin.has_value else ORIGINS[0]
    if name not in (*ORIGINS, "unknown"):
        raise origin.error(f"expected `COM` or `asset_local`, got `{name[:40]}`")
    return Placement(
        place.vector(3) if place.has_value else np.zeros(3),
        quat_matrix(quaternion[None])[0],
        np.clip(scale, -MAX_SCALE, MAX_SCALE),
        name == "asset_local",
    )


def asset_frame(template: HabitatTemplate, up: str = "") -> Matrix:
    """Return the rotation that turns an asset's `up` to +y and its `front` to -z, and its scale to metres.

    Args:
        template: Stage or object. Axes that are not at right angles are those of glTF instead, as in Habitat.
        up: Axis that points up, `y` or `z`, if the template does not say; "": `y`.
    """
    matrix = np.eye(4)
    stated = template.member("up")
    if not stated.has_value and up == "z":
        matrix[:3, :3] = Z_UP.T
    elif stated.has_value:
        matrix[:3, :3] = _turn(stated.vector(3), template.member("front"))
    units, scale = template.member("units_to_meters"), template.member("scale")
    factors = (scale.vector(3) if scale.has_value else np.ones(3)) * (units.coordinate() if units.has_value else 1.0)
    matrix[:3, :3] = np.diag(np.clip(factors, -MAX_SCALE, MAX_SCALE)) @ matrix[:3, :3]
    return matrix


def _turn(up: Float[np.ndarray, "3"], front: JsonValue) -> Float[np.ndarray, "3 3"]:
    """Return the rotation that turns `up` to +y and `front` to -z."""
    ahead = front.vector(3) if front.has_value else np.array([0.0, 0, -1])
    lengths = np.linalg.norm(up), np.linalg.norm(ahead)
    if min(lengths) < 1e-6 or abs(up @ ahead) > 1e-3 * lengths[0] * lengths[1]:
        return np.eye(3)
    up, ahead = up / lengths[0], ahead / lengths[1]
    return np.stack([np.cross(ahead, up), up, -ahead])


def asset_matrix(
    placement: Placement, frame: Matrix, center: Float[np.ndarray, "3"] | None, box: Float[np.ndarray, "2 3"]
) -> Matrix:
    """Return scene from asset.

    Args:
        placement: Place of the instance.
        frame: Result of `asset_frame`.
        center: Stated centre of mass in the oriented asset [m]; None: the middle of its bounding box.
        box: Minimum and maximum corner of the oriented and scaled asset, without the instance's scale [m].
    """
    scale = np.eye(4)
    scale[:3, :3] = np.diag(placement.scale)
    matrix = scale @ frame
    if not placement.is_local:
        middle = center if center is not None else box.mean(axis=0)
        matrix[:3, 3] -= placement.scale * middle
    return placement.rigid @ matrix


def is_valid(matrix: Matrix) -> bool:
    """Return whether a transform has a volume and moves nothing beyond all limits."""
    return bool(abs(np.linalg.det(matrix[:3, :3])) > MIN_VOLUME and abs(matrix).max() <= MAX_COORDINATE)
