"""URDF files: links with their shapes, and joints with their limits, as a checked tree."""

import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.mjcf.files import read_xml
from home_mjx.datasets.suncg.formats.json_value import MAX_COORDINATE, JsonValue, Location, printable
from home_mjx.geometry.rotations import quat_matrix

Matrix = Float[np.ndarray, "4 4"]
Colors = Mapping[str, tuple[float, ...] | None]
MAX_LINKS = 5_000  # maximum number of links and of joints
MAX_DEPTH = 200  # maximum number of nested links
HINGES, SLIDES, FIXED = ("revolute", "continuous"), ("prismatic",), ("fixed", "floating", "planar")
SHAPES = {"box": "size", "cylinder": "radius length", "sphere": "radius", "capsule": "radius length", "mesh": ""}


@dataclass(frozen=True)
class UrdfShape:
    """A shape of a link.

    Attributes:
        kind: One of `SHAPES`.
        origin: Link from shape.
        size: Edges of a box, radius and length of round shapes, or factors of a mesh.
        file: File of a mesh; null for other shapes.
        rgba: Colour and opacity of its material, 0..1; None if the file does not say.
    """

    kind: str
    origin: Matrix
    size: tuple[float, ...]
    file: JsonValue
    rgba: tuple[float, ...] | None = None


@dataclass(frozen=True)
class UrdfLink:
    """A link with its visible and its collision shapes."""

    name: str
    visuals: tuple[UrdfShape, ...]
    collisions: tuple[UrdfShape, ...]


@dataclass(frozen=True)
class UrdfJoint:
    """A joint between two links.

    Attributes:
        name: Its name.
        kind: One of `HINGES`, `SLIDES` and `FIXED`.
        parent: Link that carries it.
        child: Link that it moves.
        origin: Parent from joint.
        axis: Unit vector in the joint's frame.
        low: Minimum [rad] or [m].
        high: Maximum [rad] or [m].
    """

    name: str
    kind: str
    parent: str
    child: str
    origin: Matrix
    axis: Float[np.ndarray, "3"]
    low: float
    high: float

    @property
    def is_movable(self) -> bool:
        """Whether it is a hinge or a slide."""
        return self.kind in HINGES + SLIDES


@dataclass(frozen=True)
class UrdfModel:
    """A robot or piece of furniture.

    Attributes:
        path: Its file.
        links: Links by name, in the order of the file.
        joints: Joints by the link that they move.
    """

    path: Path
    links: Mapping[str, UrdfLink]
    joints: Mapping[str, UrdfJoint]

    @cached_property
    def children(self) -> Mapping[str, tuple[str, ...]]:
        """Links that each link carries."""
        found: dict[str, tuple[str, ...]] = dict.fromkeys(self.links, ())
        for joint in self.joints.values():
            found[joint.parent] = (*found[joint.parent], joint.child)
        return found

    @property
    def root(self) -> str:
        """Link that no joint moves."""
        return next(name for name in self.links if name not in self.joints)

    def subtree(self, link: str, depth: int = 0) -> Iterator[str]:
        """Yield a link and all that it carries, depth first."""
        if depth > MAX_DEPTH:
            raise Location(self.path, f"link[{printable(link[:80])}]").error(
                f"links are more than {MAX_DEPTH} levels deep"
            )
        yield link
        for child in self.children[link]:
            yield from self.subtree(child, depth + 1)


def read_urdf(path: Path) -> UrdfModel:
    """Read a URDF file.

    Raises:
        MissingFileError: The file is missing.
        DatasetError: It is not URDF, a number is missing or not finite, or its links are no tree.
    """
    root = read_xml(path, ("robot",))
    colors = {node.get("name", ""): _color(path, node, {}) for node in root.findall("material")}
    links: dict[str, UrdfLink] = {}
    joints: dict[str, UrdfJoint] = {}
    for node in root:
        if node.tag == "link":
            link = _link(path, node, colors)
            if link.name in links:
                raise _place(path, node).error("link is there twice", "Rename one of the two.")
            links[link.name] = link
        elif node.tag == "joint":
            joint = _joint(path, node)
            if joint.child in joints:
                raise _place(path, node).error(f"link `{printable(joint.child[:60])}` is moved by two joints")
            joints[joint.child] = joint
    _check_tree(path, links, joints)
    return UrdfModel(path, links, joints)


def _check_tree(path: Path, links: Mapping[str, UrdfLink], joints: Mapping[str, UrdfJoint]) -> None:
    """Raise `DatasetError` unless all joints are between links, which are one tree."""
    place = Location(path, "robot")
    if max(len(links), len(joints)) > MAX_LINKS:
        raise place.error(f"file has more than {MAX_LINKS} links")
    for joint in joints.values():
        for name in (joint.parent, joint.child):
            if name not in links:
                raise Location(path, f"joint[{printable(joint.name[:80])}]").error(
                    f"no link is called `{printable(name[:60])}`"
                )
    roots = [name for name in links if name not in joints]
    if len(roots) != 1:
        raise place.error(f"expected one link that no joint moves, got {len(roots)}", "Join the parts by fixed joints.")
    seen, left = 0, [roots[0]]
    below: dict[str, list[str]] = {}
    for joint in joints.values():
        below.setdefault(joint.parent, []).append(joint.child)
    while left:
        seen += 1
        left += below.get(left.pop(), [])
    if seen != len(links):
        raise place.error("links carry each other in a circle", "Correct the parents of its joints.")


def _link(path: Path, node: ET.Element, colors: Colors) -> UrdfLink:
    """Read a link, with the colours of named materials."""
    shapes = {tag: tuple(_shape(path, part, colors) for part in node.findall(tag)) for tag in ("visual", "collision")}
    return UrdfLink(_name(path, node), shapes["visual"], shapes["collision"])


def _color(path: Path, node: ET.Element | None, colors: Colors) -> tuple[float, ...] | None:
    """Return the colour of a `material`: its own, else that of the named one; None without any."""
    own = None if node is None else node.find("color")
    if own is None:
        return None if node is None else colors.get(node.get("name", ""))
    return tuple(min(max(value, 0.0), 1.0) for value in _numbers(path, own, "rgba", 4, None))


def _shape(path: Path, node: ET.Element, colors: Colors) -> UrdfShape:
    """Read a visual or collision shape."""
    geometry = node.find("geometry")
    shape = next(iter(geometry), None) if geometry is not None else None
    place = _place(path, node)
    if shape is None or shape.tag not in SHAPES:
        raise place.error("expected a geometry of box, cylinder, sphere, capsule or mesh")
    origin, rgba = _origin(path, node), _color(path, node.find("material"), colors)
    if shape.tag == "mesh":
        scale = _numbers(path, shape, "scale", 3, (1.0, 1.0, 1.0))
        name = shape.get("filename", "").removeprefix("package://").removeprefix("file://")
        return UrdfShape("mesh", origin, scale, JsonValue(path, "mesh.filename", name), rgba)
    counts = {"size": 3, "radius": 1, "length": 1}
    size = tuple(v for key in SHAPES[shape.tag].split() for v in _numbers(path, shape, key, counts[key], None))
    if min(size) < 0:
        raise place.error(f"size of the {shape.tag} is negative")
    return UrdfShape(shape.tag, origin, size, JsonValue(path, "geometry"), rgba)


def _joint(path: Path, node: ET.Element) -> UrdfJoint:
    """Read a joint; without limits, continuous ones make half a turn to both sides, and others do not move."""
    kind, place = node.get("type", ""), _place(path, node)
    if kind not in HINGES + SLIDES + FIXED:
        raise place.error(f"unknown type of joint `{printable(kind[:40])}`")
    ends = [node.find(tag) for tag in ("parent", "child")]
    parent, child = ("" if end is None else end.get("link", "") for end in ends)
    axis = np.array(_numbers(path, node.find("axis"), "xyz", 3, (1.0, 0.0, 0.0)))
    length = float(np.linalg.norm(axis))
    if kind not in FIXED and length < 1e-9:
        raise place.error("axis has no length")
    limit = node.find("limit")
    free = np.pi if kind == "continuous" else 0.0
    low, high = (_numbers(path, limit, key, 1, (way * free,))[0] for key, way in (("lower", -1), ("upper", 1)))
    if low > high:
        raise place.error(f"lower limit {low:g} is above the upper one, {high:g}")
    unit = axis / length if length else axis
    return UrdfJoint(_name(path, node), kind, parent, child, _origin(path, node), unit, low, high)


def _origin(path: Path, node: ET.Element) -> Matrix:
    """Return the transform of the `origin` of an element: rpy about the fixed axes x, y, z, then xyz."""
    found = node.find("origin")
    roll, pitch, yaw = (angle / 2 for angle in _numbers(path, found, "rpy", 3, (0.0, 0.0, 0.0)))
    matrix = np.eye(4)
    turns = [(math.cos(roll), math.sin(roll), 0, 0), (math.cos(pitch), 0, math.sin(pitch), 0)]
    x, y, z = quat_matrix(np.array([*turns, (math.cos(yaw), 0, 0, math.sin(yaw))]))
    matrix[:3, :3] = z @ y @ x
    matrix[:3, 3] = _numbers(path, found, "xyz", 3, (0.0, 0.0, 0.0))
    return matrix


def _numbers(
    path: Path, node: ET.Element | None, key: str, count: int, default: tuple[float, ...] | None
) -> tuple[float, ...]:
    """Return the numbers of an attribute, separated by spaces or commas; `default` if it is absent."""
    text = None if node is None else node.get(key)
    if text is None and default is not None:
        return default
    try:
        found = tuple(float(part) for part in re.split(r"[\s,]+", (text or "").strip()))
    except ValueError:
        found = ()
    if len(found) != count or not all(abs(value) <= MAX_COORDINATE for value in found):
        place = Location(path, f"{'' if node is None else node.tag}.{key}")
        raise place.error(f"expected {count} finite numbers, got `{printable((text or 'nothing')[:60])}`")
    return found


def _name(path: Path, node: ET.Element) -> str:
    """Return the name of an element."""
    name = node.get("name")
    if not name:
        raise Location(path, str(node.tag)).error("element has no name")
    return name


def _place(path: Path, node: ET.Element) -> Location:
    """Return the location of an element."""
    return Location(path, f"{node.tag}[{printable(node.get('name', '')[:80])}]")
