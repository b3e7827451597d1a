"""Files of an MJCF scene, checked before MuJoCo opens them: paths below the scene's root, and bounded sizes."""

import re
import struct
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from home_mjx.core.files import is_file, open_regular, read_text, resolve_below
from home_mjx.core.images import MAX_PIXELS
from home_mjx.datasets.suncg.formats.json_value import Location, printable
from home_mjx.errors import DatasetError, MissingFileError

MAX_XML_BYTES = 1 << 26  # [bytes], maximum size of one XML file
MAX_TOTAL_BYTES = 1 << 30  # [bytes], maximum size of all files of a scene
MAX_HEIGHTS = 1_000_000  # maximum number of heights of a field, and of all that a scene shows
MAX_COPIES = 20_000  # maximum number of copies that `replicate` and grids of deformable bodies make
MAX_ELEMENTS = 1_000_000  # maximum number of elements, each counted as often as it is replicated
MAX_DEPTH = 200  # maximum number of nested elements; MuJoCo reads them by recursion
MAX_MODEL_DEPTH = 8  # maximum number of nested `model` assets
FILE_ATTRIBUTES = ("file", "fileright", "fileleft", "fileup", "filedown", "filefront", "fileback")
PNG_HEAD = b"\x89PNG\r\n\x1a\n"
URI_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]+:")  # two letters and more: `C:` is a drive
PACKAGE_FILES = ("LICENSE", "LICENSE.md", "LICENSE.txt", ".git")
NUM_PARENTS = 2  # maximum number of folders above a scene that may be its package


def package_root(scene: Path) -> Path:
    """Return the folder whose files a scene may name: the nearest of its folder and two above that has a licence.

    That is the scene's own folder if none has one.
    """
    folders = [scene.parent, *scene.parent.parents][: NUM_PARENTS + 1]
    return next((f for f in folders if any((f / name).exists() for name in PACKAGE_FILES)), scene.parent)


@dataclass(frozen=True)
class XmlElement(Location):
    """An element of an XML file.

    Attributes:
        node: The parsed element.
        copies: Number of copies that `replicate` makes of it.
    """

    node: ET.Element = field(kw_only=True)
    copies: int = 1


@dataclass
class SceneFiles:
    """Files of a scene, collected by `add_model`.

    Attributes:
        root: Folder that contains all of them.
        paths: The files, in the order in which they are named.
    """

    root: Path
    paths: dict[Path, None] = field(default_factory=dict)
    _num_bytes: int = 0
    _num_elements: int = 0

    def add_model(self, path: Path, above: tuple[Path, ...] = ()) -> None:
        """Add an MJCF file and all files that it names, also through includes and other models.

        Args:
            path: The file.
            above: Models that name it.

        Raises:
            MissingFileError: A file is missing.
            DatasetError: A file is not MJCF, is too large, or has a path that leads out of the root; an element would
                make too many copies, or needs a plug-in; files name themselves.
        """
        elements = list(self._elements(path, path.parent, ()))
        folders = _asset_folders(elements)
        for element in elements:
            _check_counts(element)
            self._num_elements += element.copies
            if self._num_elements > MAX_ELEMENTS:
                raise element.error(f"scene has more than {MAX_ELEMENTS} elements", "Split it.")
            if element.node.tag not in ("include", "compiler"):
                self._add_assets(element, path, folders, (*above, path))

    def _elements(self, path: Path, folder: Path, above: tuple[Path, ...]) -> Iterator[XmlElement]:
        """Yield the elements of a file and of those that it includes, whose paths are relative to `folder`."""
        self._add(path, Location(path, "mujoco"))
        stack = [(XmlElement(path, "mujoco", node=read_xml(path)), 1)]
        while stack:
            found, depth = stack.pop()
            if depth > MAX_DEPTH:
                raise found.error(f"elements are more than {MAX_DEPTH} levels deep", "Flatten it.")
            yield found
            copies = found.copies * _whole(found.node.get("count", "1") if found.node.tag == "replicate" else "1")
            for node in reversed(found.node):
                stack.append((XmlElement(path, _place(node), node=node, copies=copies), depth + 1))
            if found.node.tag == "include":
                inner = self._path(found, found.node.get("file", ""), folder)
                if inner in (path, *above) or len(above) > MAX_DEPTH:
                    raise found.error(f"{inner.name} includes itself", "Remove one of the includes.")
                yield from self._elements(inner, folder, (*above, path))

    def _add_assets(self, element: XmlElement, path: Path, folders: dict[str, str], above: tuple[Path, ...]) -> None:
        """Add the files that an element's attributes name."""
        tag = element.node.tag
        for name in FILE_ATTRIBUTES:
            text = element.node.get(name)
            if text and tag == "model":
                inner = self._path(element, text, path.parent)
                if inner in above or len(above) > MAX_MODEL_DEPTH:
                    raise element.error(f"model {inner.name} contains itself", "Remove one of the models.")
                self.add_model(inner, above)
            elif text:
                text = Path(text.replace("\\", "/")).name if folders["strippath"] == "true" else text
                folder = folders["texturedir" if tag == "texture" else "meshdir"]
                self._add(self._path(element, text, path.parent / folder), element)

    def _path(self, place: Location, text: str, folder: Path) -> Path:
        """Return the path that a text names; it must be below the root, also after symbolic links."""
        hint = "Name its package by `?root=FOLDER`, or put the file into the folder of the scene."
        if not text or "\0" in text or URI_SCHEME.match(text):
            raise place.error(f"expected a path, got `{printable(text[:60])}`", hint)
        path = resolve_below(self.root, folder, text)
        if path is None or not path.resolve().is_relative_to(self.root.resolve()):
            raise place.error(f"`{printable(text[:60])}` leads out of {self.root}", hint)
        return path

    def _add(self, path: Path, place: Location) -> None:
        """Add a file that exists, and check its size."""
        if path in self.paths:
            return
        if not is_file(path):
            raise place.error(f"file `{path}` is missing", "Fetch it, or correct its path.", MissingFileError)
        self.paths[path] = None
        self._num_bytes += path.stat().st_size
        if self._num_bytes > MAX_TOTAL_BYTES:
            raise place.error(f"files have more than {MAX_TOTAL_BYTES} bytes together", "Split the scene.")
        size = _png_pixels(path)
        if size > MAX_PIXELS:
            raise place.error(f"image has {size} pixels, at most {MAX_PIXELS} are read", "Shrink it.")


def _png_pixels(path: Path) -> int:
    """Return the number of pixels that the header of a PNG file states; 0 for other files."""
    with open_regular(path) as file:
        head = file.read(24)
    width, height = struct.unpack(">8x8xII", head) if len(head) == 24 and head.startswith(PNG_HEAD) else (0, 0)
    return width * height


def read_xml(path: Path, tags: tuple[str, ...] = ("mujoco", "mujocoinclude")) -> ET.Element:
    """Return the root element of an XML file without a document type, which could define entities.

    Args:
        path: The file.
        tags: Tags that the root element may have.

    Raises:
        DatasetError: The file is not XML, too large, or of another kind.
    """
    text = read_text(path, max_bytes=MAX_XML_BYTES)
    if "<!DOCTYPE" in text or "<!ENTITY" in text:
        raise DatasetError("document types and entities are not read", file=path, hint="Remove them.")
    try:
        root = ET.fromstring(text)
    except (ET.ParseError, ValueError, RecursionError) as error:
        raise DatasetError(f"not valid XML: {error}", file=path, hint="Correct or fetch it again.") from None
    if root.tag not in tags:
        raise DatasetError(f"expected the element `{tags[0]}`, got `{printable(root.tag[:40])}`", file=path)
    return root


def _place(node: ET.Element) -> str:
    """Return the name of an element for messages: its tag, with its name or file."""
    name = node.get("name") or node.get("file") or ""
    return f"{node.tag}[{printable(name[:80])}]" if name else str(node.tag)


def _asset_folders(elements: list[XmlElement]) -> dict[str, str]:
    """Return `meshdir`, `texturedir` and `strippath` of the last `compiler` elements that state them."""
    found = {"meshdir": "", "texturedir": "", "strippath": "false"}
    for element in elements:
        if element.node.tag == "compiler":
            both = element.node.get("assetdir")
            stated = {"meshdir": both, "texturedir": both} if both is not None else {}
            found |= stated | {key: value for key, value in element.node.items() if key in found}
    return found


def _check_counts(element: XmlElement) -> None:
    """Raise `DatasetError` if an element needs a plug-in or makes more than fits into memory."""
    tag, node = element.node.tag, element.node
    if tag in ("extension", "plugin"):
        raise element.error("plug-ins are not loaded", "Remove them from the scene.")
    grid = 1
    for text in node.get("count", "1").split() if tag in ("flexcomp", "composite") else ():
        grid *= _whole(text)
    if max(grid, element.copies) > MAX_COPIES:
        raise element.error(f"makes {max(grid, element.copies)} copies, at most {MAX_COPIES} are read")
    for first, second in (("width", "height"), ("nrow", "ncol")):
        size = _whole(node.get(first, "0")) * _whole(node.get(second, "0"))
        limit = MAX_HEIGHTS if tag == "hfield" else MAX_PIXELS
        if tag in ("texture", "hfield") and size > limit:
            raise element.error(f"has {size} texels or heights, at most {limit} are read")
    if tag == "mesh" and any(_whole(text) > 1000 for text in node.get("params", "").split()):
        raise element.error("mesh has more than 1000 segments")


def _whole(text: str) -> int:
    """Return the size of a number of the file as an integer, at least 1; 1 if it is none, which MuJoCo refuses."""
    try:
        return max(1, int(abs(float(text))))
    except (ValueError, OverflowError):
        return 1
