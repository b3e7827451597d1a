"""Objects of a Habitat scene: rigid and articulated instances of templates."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from home_mjx.core.files import is_file
from home_mjx.datasets.furniture import FurnitureProvider
from home_mjx.datasets.gltf.decode.scene import Matrix
from home_mjx.datasets.gltf.objects import MeshObject, move_mesh
from home_mjx.datasets.habitat.articulated import ArticulatedReader, move_joint, read_pose, wall_frame
from home_mjx.datasets.habitat.assets import AssetStore, mesh_bounds, primitive_mesh
from home_mjx.datasets.habitat.semantics import fine_of_word
from home_mjx.datasets.habitat.source import HabitatSource
from home_mjx.datasets.habitat.stand_ins import stand_in
from home_mjx.datasets.habitat.templates import HabitatTemplate, path_below
from home_mjx.datasets.habitat.transforms import Placement, asset_frame, asset_matrix, is_valid, read_placement
from home_mjx.datasets.habitat.urdf import read_urdf
from home_mjx.datasets.suncg.formats.json_value import JsonValue
from home_mjx.datasets.taxonomy import UNKNOWN
from home_mjx.errors import DatasetError, MissingFileError
from home_mjx.schema.house import Fallback, Mesh, Problem

MIN_FLOOR_LAMP = 1.0  # [m], minimum height of lamps that stand on the floor
KEPT_ATTRIBUTES = ("mass", "semantic_id", "user_defined")


@dataclass
class ObjectBuilder:
    """Builder of the objects of one scene.

    Attributes:
        source: The dataset.
        assets: Its assets.
        provider: Our furniture.
        classes: Word of each semantic id.
        table: Words by model, see `read_object_table`.
        strict: Whether missing assets are errors.
        fallbacks: Our furniture in place of missing assets.
        problems: Instances that are left out.
    """

    source: HabitatSource
    assets: AssetStore
    provider: FurnitureProvider
    classes: Mapping[int, str]
    table: Mapping[str, tuple[str, ...]]
    strict: bool
    fallbacks: list[Fallback] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)

    def rigid(self, value: JsonValue, origin: JsonValue) -> MeshObject | None:
        """Return a rigid instance; None if it has no volume.

        Raises:
            DatasetError: It names several templates, a value or its asset is broken or, if strict, missing.
        """
        name, placement = value.member("template_name"), read_placement(value, origin)
        template = self.source.table("objects").find(name)
        if template is None:
            self._check_strict(name)
            return self._replaced(value, placement, None, np.eye(4), "template is missing")
        frame = asset_frame(template)
        try:
            key, mesh = self._asset(template, "render_asset")
        except MissingFileError as error:
            if self.strict:
                raise
            return self._replaced(value, placement, template, frame, error.message)
        if mesh is None:
            self.problems.append(Problem(value.element, "asset shows nothing: left out"))
            return None
        box = mesh_bounds(mesh, frame)
        matrix = asset_matrix(placement, frame, self._center(template), box)
        return self._object(value, template, key, mesh, matrix)

    def _asset(self, template: HabitatTemplate, attribute: str) -> tuple[str, Mesh | None]:
        """Return the key and the mesh of an asset that a template names; by default its own file."""
        value, folder = template.text(attribute)
        primitive = primitive_mesh(value) if value.has_value else None
        if primitive is not None:
            return value.text().lower()[:60], primitive
        if value.has_value:
            path = path_below(self.source.root, folder, value)
        elif template.file is not None and not template.file.name.endswith(".json"):
            path = template.file
        else:
            raise template.member(attribute).error(f"template has no `{attribute}`", None, MissingFileError)
        return digest_of(path.relative_to(self.source.root).as_posix()), self.assets.mesh(path)

    def _center(self, template: HabitatTemplate) -> Float[np.ndarray, "3"] | None:
        """Return the stated centre of mass of an oriented, scaled asset [m]; None if it is not stated."""
        center, scale = template.member("COM"), template.member("scale")
        if not center.has_value:
            return None
        return center.vector(3) * (scale.vector(3) if scale.has_value else 1.0)

    def _object(
        self, value: JsonValue, template: HabitatTemplate | None, key: str, mesh: Mesh, matrix: Matrix
    ) -> MeshObject | None:
        """Return an object; None, with a note, if its transform has no volume or is beyond all limits."""
        if not is_valid(matrix):
            self.problems.append(Problem(value.element, "transform without volume, or beyond all limits: left out"))
            return None
        fine, word = self.category(value.member("template_name").text(), template)
        if fine == "floor_lamp" and np.ptp(mesh_bounds(mesh, matrix)[:, 1]) < MIN_FLOOR_LAMP:
            fine = "table_lamp"
        return MeshObject(fine, f"{fine}_{key}", matrix, mesh, (), self._extra(value, template, word))

    def category(self, name: str, template: HabitatTemplate | None) -> tuple[str, str]:
        """Return the fine category of an instance, and the dataset's word for it; "" without one."""
        own = name.rpartition("/")[2]
        words = []
        if template is not None:
            number = template.member("semantic_id")
            if isinstance(number.data, int) and number.data in self.classes:
                words.append(self.classes[number.data])
            elif isinstance(number.data, str):
                words.append(number.data[:100])
            own = template.name
        words += self.table.get(own, ())
        found = next((fine for word in (*words, own) if (fine := fine_of_word(word)) != UNKNOWN), UNKNOWN)
        return found, words[0] if words else ""

    def _extra(self, value: JsonValue, template: HabitatTemplate | None, word: str) -> dict[str, Any]:
        """Return the entries of an object that nothing here uses."""
        found = {"name": value.member("template_name").text(), "category": word}
        motion = value.member("motion_type")
        if motion.has_value:
            found["motion_type"] = motion.text().upper()[:20]
        kept = {key: template.member(key).data for key in KEPT_ATTRIBUTES} if template is not None else {}
        return found | {key: data for key, data in kept.items() if data is not None}

    def _replaced(
        self, value: JsonValue, placement: Placement, template: HabitatTemplate | None, frame: Matrix, reason: str
    ) -> MeshObject | None:
        """Return our furniture in place of a missing asset, in the box of its collider if that is known."""
        name = value.member("template_name")
        fine, _ = self.category(name.text(), template)
        box = self._collider_box(template, frame)
        key, mesh, matrix, words = stand_in(self.provider, fine, box, name.text())
        whole = np.zeros((2, 3)) if box is None else box
        center = self._center(template) if template is not None else None
        placed = asset_matrix(placement, np.eye(4), center, whole) @ matrix
        self.fallbacks.append(Fallback("model", name.text()[:100], value.element, words, reason))
        return self._object(value, template, key, mesh, placed)

    def _collider_box(self, template: HabitatTemplate | None, frame: Matrix) -> Float[np.ndarray, "2 3"] | None:
        """Return the box of a template's collision asset in the oriented asset [m]; None if there is none."""
        if template is None or not template.member("collision_asset").has_value:
            return None
        try:
            _, mesh = self._asset(template, "collision_asset")
        except DatasetError:
            return None
        return None if mesh is None else mesh_bounds(mesh, frame)

    def _check_strict(self, name: JsonValue) -> None:
        """Raise `MissingFileError` for a missing template, if strict."""
        if self.strict:
            raise name.error(f"no template is called `{name.text()[:60]}`", "Fetch it.", MissingFileError)

    def articulated(self, value: JsonValue, origin: JsonValue) -> MeshObject | None:
        """Return an articulated instance; errors as of `rigid`."""
        name, placement = value.member("template_name"), read_placement(value, origin)
        template = self.source.table("articulated_objects").find(name)
        path = self._urdf_path(template) if template is not None else None
        if template is None or path is None or not is_file(path):
            self._check_strict(name)
            return self._missing_articulated(value, placement, template)
        scale = float(placement.scale[0])
        if not scale > 0:
            self.problems.append(Problem(value.element, f"articulated objects have no scale of {scale:g}: left out"))
            return None
        model = read_urdf(path)
        pose = read_pose(value.member("initial_joint_pose"), model)
        reader = ArticulatedReader(model, self.source.root, self.assets, self.strict, scale, pose)
        fine, word = self.category(name.text(), template)
        mesh, joints = reader.read(fine)
        self.fallbacks += reader.fallbacks
        carried = sum(joint.is_movable for joint in model.joints.values()) - len(joints)
        if carried:
            message = f"{carried} joints move nothing, or parts that other joints move: fixed"
            self.problems.append(Problem(value.element, message))
        if mesh is None:
            self.problems.append(Problem(value.element, "no link is visible: left out"))
            return None
        text = f"{path.relative_to(self.source.root).as_posix()} {scale} {sorted(pose.items())}"
        extra, matrix = self._extra(value, template, word), placement.rigid
        if fine == "door" and joints:
            frame = wall_frame(mesh, joints)
            mesh, joints = (
                move_mesh(mesh, np.linalg.inv(frame)),
                tuple(move_joint(joint, np.linalg.inv(frame)) for joint in joints),
            )
            matrix = matrix @ frame
        return MeshObject(fine, f"{fine}_{digest_of(text)}", matrix, mesh, joints, extra)

    def _urdf_path(self, template: HabitatTemplate) -> Path | None:
        """Return the URDF file of a template: the one it names, else its own, else the one beside its configuration."""
        value, folder = template.text("urdf_filepath")
        if value.has_value:
            return path_below(self.source.root, folder, value)
        if template.file is None or template.file.name.endswith(".urdf"):
            return template.file
        return template.file.with_name(f"{template.name}.urdf")

    def _missing_articulated(
        self, value: JsonValue, placement: Placement, template: HabitatTemplate | None
    ) -> MeshObject | None:
        """Return our furniture in place of a missing URDF file; None for doors, whose place in the wall is unknown."""
        name = value.member("template_name").text()
        fine, _ = self.category(name, template)
        if fine in ("door", UNKNOWN):
            words = "left out, since its shape and place are unknown"
            self.fallbacks.append(Fallback("model", name[:100], value.element, words))
            return None
        key, mesh, matrix, words = stand_in(self.provider, fine, None, name)
        pose = upright(placement)
        low = mesh_bounds(mesh, pose @ matrix)[0, 1]
        if -0.5 < placement.translation[1] < 0.3:  # its origin is at its foot
            pose[1, 3] += placement.translation[1] - low
        self.fallbacks.append(Fallback("model", name[:100], value.element, words, "URDF file is missing"))
        return self._object(value, template, key, mesh, pose @ matrix)


def upright(placement: Placement) -> Matrix:
    """Return a place turned about +y alone, by the direction of its x axis in the plan."""
    x, _, z = placement.rotation[:, 0].tolist()
    yaw = np.arctan2(-z, x) if np.hypot(x, z) > 0.5 else 0.0
    pose = np.eye(4)
    c, s = np.cos(yaw), np.sin(yaw)
    pose[:3, :3] = [[c, 0, s], [0, 1, 0], [-s, 0, c]]
    pose[:3, 3] = placement.translation
    return pose


def digest_of(text: str) -> str:
    """Return 12 hexadecimal digits of the digest of a text."""
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def kept_objects(found: Sequence[MeshObject | None]) -> list[MeshObject]:
    """Return the objects that are not None."""
    return [one for one in found if one is not None]
