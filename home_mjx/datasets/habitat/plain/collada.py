"""COLLADA documents (DAE): their text and instances within bounds, their axes and their unit."""

import re
from collections.abc import Iterator, Mapping
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.suncg.formats.json_value import Location, printable
from home_mjx.errors import DatasetError

EXPORT = "Export it again, as a COLLADA 1.4 document in UTF-8."
ENTITY = re.compile(rb"<!ENTITY|<!DOCTYPE", re.IGNORECASE)
ENCODING = re.compile(rb"<\?xml[^<>]{0,200}?\bencoding\s*=\s*[\"']([^\"'<>]{1,40})[\"']")
ENCODINGS = (b"utf-8", b"us-ascii", b"ascii", b"iso-8859-1", b"windows-1252")
MAX_TAGS = 1 << 21  # maximum number of "<", which bounds the memory of elements
MAX_DEPTH = 200  # maximum number of nested elements, each of which is searched for all below it
MAX_NODES = 100_000  # maximum number of nodes, without their instances
NODE_COST = 1_000  # [characters], time of an instance of a node, as that of so much text of indices
MAX_SHOWN = 1 << 28  # [characters], maximum text of indices that a scene shows, that of each instance counted
UNSUPPORTED = {"instance_controller": "skins and morphs", "ph": "polygons with holes"}
UP = {"X_UP": [[0, -1, 0], [1, 0, 0], [0, 0, 1]], "Y_UP": np.eye(3), "Z_UP": [[1, 0, 0], [0, 0, 1], [0, -1, 0]]}


def collada_frame(path: Path, data: bytes) -> Float[np.ndarray, "4 4"]:
    """Return the transform of a COLLADA document to metres and y up, once its content is known to be bounded.

    Args:
        path: The file, for messages.
        data: Its content.

    Raises:
        DatasetError: The text is no XML, in another encoding, or declares entities; it has elements that are not
            supported, or too many; a node is its own ancestor; instances show too much or name what does not exist.
    """
    root = _parse(path, data)
    found = next((e for e in root.iter() if _tag(e) in UNSUPPORTED), None)
    if found is not None:
        raise _error(path, found, f"{UNSUPPORTED[_tag(found)]} are not supported")
    if _shown(path, root) > MAX_SHOWN:
        raise Location(path).error(f"instances show more than {MAX_SHOWN} characters of indices", "Remove instances.")
    return _frame(path, root)


def _parse(path: Path, data: bytes) -> Element:
    """Return the root of a document whose text and depth are bounded, and which has no entities."""
    text = data.removeprefix(b"\xef\xbb\xbf").lstrip()
    encoding = ENCODING.match(text)
    if text[:1] != b"<" or b"\0" in text or (encoding is not None and encoding[1].lower() not in ENCODINGS):
        raise Location(path).error("not an XML document in UTF-8", EXPORT)
    if ENTITY.search(text):
        raise Location(path).error("file declares entities", EXPORT)
    if text.count(b"<") > MAX_TAGS:
        raise Location(path).error(f"file has more than {MAX_TAGS} tags", "Write polygons as one list of triangles.")
    try:
        root = ElementTree.fromstring(text)
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise Location(path).error(f"not an XML document: {error}", EXPORT) from None
    if _tag(root) != "COLLADA":
        raise _error(path, root, "expected a COLLADA document")
    level = [root]
    for _ in range(MAX_DEPTH):
        level = [child for element in level for child in element]
    if level:
        raise _error(path, level[0], f"elements are more than {MAX_DEPTH} levels deep")
    return root


def _shown(path: Path, root: Element) -> int:
    """Return the text of indices that the scenes of a document show [characters], that of each instance counted."""
    nodes = [e for e in root.iter() if _tag(e) in ("node", "visual_scene")]
    if len(nodes) > MAX_NODES:
        raise Location(path).error(f"document has more than {MAX_NODES} nodes", "Join its meshes.")
    named = {e.get("id"): e for e in nodes if e.get("id")}
    sizes = {e.get("id"): sum(map(_length, e.iter())) for e in root.iter() if _tag(e) == "geometry"}
    below = {e: list(_children(path, e, named)) for e in nodes}
    total: dict[Element, int] = {}
    try:
        order = list(TopologicalSorter(below).static_order())
    except CycleError as error:
        raise _error(path, error.args[1][0], "node is its own ancestor") from None
    for one in order:
        own = NODE_COST + sum(sizes[_target(path, e, sizes)] for e in one if _tag(e) == "instance_geometry")
        total[one] = min(own + sum(total[e] for e in below[one]), MAX_SHOWN + 1)
    return max((total[e] for e in nodes if _tag(e) == "visual_scene"), default=0)


def _children(path: Path, node: Element, named: dict[str | None, Element]) -> Iterator[Element]:
    """Yield the nodes directly below a node, and those of which it has instances."""
    for child in node:
        if _tag(child) == "node":
            yield child
        elif _tag(child) == "instance_node":
            yield named[_target(path, child, named)]


def _target(path: Path, instance: Element, known: Mapping[str | None, object]) -> str:
    """Return the id that an instance names; raise if it is not known, as in another file."""
    url = instance.get("url", "")
    if not url.startswith("#") or url[1:] not in known:
        raise _error(path, instance, f"instance of `{printable(url[:60])}`, which is not in the document")
    return url[1:]


def _frame(path: Path, root: Element) -> Float[np.ndarray, "4 4"]:
    """Return the transform of a document to metres and y up."""
    stated = {_tag(e): e for asset in root if _tag(asset) == "asset" for e in asset}
    axis = (stated["up_axis"].text or "").strip() if "up_axis" in stated else "Y_UP"
    unit = stated["unit"].get("meter", "1") if "unit" in stated else "1"
    try:
        scale = float(unit)
    except ValueError:
        scale = 0.0
    if axis not in UP or not 1e-6 <= scale <= 1e6:
        raise _error(path, root, f"expected an axis of {', '.join(UP)} and a unit in metres, got `{axis}`, `{unit}`")
    matrix = np.eye(4)
    matrix[:3, :3] = np.array(UP[axis]) * scale
    return matrix


def _length(element: Element) -> int:
    """Return the length of the indices of a primitive; 0 for other elements."""
    return len(element.text or "") if _tag(element) == "p" else 0


def _tag(element: Element) -> str:
    """Return the name of an element without its namespace."""
    return str(element.tag).rpartition("}")[2]


def _error(path: Path, element: Element, message: str) -> DatasetError:
    """Return, without raising it, an error at an element."""
    name = element.get("id") or element.get("name")
    return Location(path, f"<{_tag(element)}{f' {name}' if name else ''}>").error(message, EXPORT)
