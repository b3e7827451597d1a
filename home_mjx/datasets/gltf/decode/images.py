"""Images of a glTF document, written to the cache folder as files of their own, named by use and content."""

import hashlib
import os
import re
from dataclasses import dataclass, field
from pathlib import Path

from home_mjx.core.files import write_atomically
from home_mjx.core.images import open_texture
from home_mjx.datasets.gltf.decode.container import TEXTURE_EXTENSIONS, GltfDocument, refuse_extensions
from home_mjx.datasets.suncg.formats.json_value import JsonValue, printable
from home_mjx.errors import ConfigError, DatasetError, MissingFileError
from home_mjx.schema.house import Fallback
from home_mjx.schema.material_kinds import TEXTURE_KINDS

MAX_IMAGE_BYTES = 1 << 25  # [bytes], maximum size of an image file, as of `core.files`
NUM_DIGITS = 18  # decimal digits of the content's digest in a file name
SUFFIXES = {b"\x89PNG": ".png", b"\xff\xd8\xff": ".jpg"}
# Words in names of materials and images, beside those of `TEXTURE_KINDS`, that tell the family of a texture.
FAMILY_WORDS = {
    "brick": "bricks",
    "curtain": "textile",
    "drywall": "stucco",
    "fabric": "textile",
    "granite": "marble",
    "oak": "wood",
    "parquet": "laminate",
    "plaster": "stucco",
    "rug": "carpet",
    "steel": "metal",
    "tiles": "tile",
    "wallpaper": "wallp",
    **{family: family for family in TEXTURE_KINDS},
}


@dataclass(frozen=True)
class LostImage:
    """An image that is not used.

    Attributes:
        place: The texture or image.
        error: Reason, and a remedy if there is one.
    """

    place: JsonValue
    error: DatasetError


@dataclass
class ImageStore:
    """Images of one document, written to a folder on first use.

    Attributes:
        document: The document.
        folder: Folder of the files; created when the first one is written.
        strict: Reject missing and broken images, instead of noting them in `fallbacks`.
        fallbacks: Images that materials do without.
    """

    document: GltfDocument
    folder: Path
    strict: bool
    fallbacks: list[Fallback] = field(default_factory=list)
    _found: dict[tuple[int, str], Path | LostImage] = field(default_factory=dict)
    _listed: set[str] = field(default_factory=set)

    def path(self, texture: JsonValue, name: str, replacement: str = "the material's colour") -> Path | None:
        """Return the file of a texture's image; None, with a fallback, if it is missing or broken.

        Args:
            texture: Reference of a material to a texture, with `index`.
            name: Name of the material, whose words select the family of the texture.
            replacement: What the material has without the image, for the fallback.

        Raises:
            DatasetError: An index is out of range; or, if strict, the image is missing, broken or of another format.
        """
        found = self.find(texture, name)
        if isinstance(found, Path):
            return found
        if self.strict:
            raise found.error
        place = found.place
        if place.element not in self._listed:
            self._listed.add(place.element)
            shown = _image_name(place) or os.path.basename(place.element)
            self.fallbacks.append(Fallback("texture", shown, place.element, replacement, found.error.message))
        return None

    def find(self, texture: JsonValue, name: str) -> Path | LostImage:
        """Return the file of a texture's image, or the reason why it is not used; arguments as of `path`.

        Raises:
            DatasetError: An index is out of range.
        """
        value = self.document.item("textures", texture.member("index"))
        source = value.member("source")
        if not source.has_value:
            return _lost(value, "texture has no PNG or JPEG `source`", _undecoded(value))
        image = self.document.item("images", source)
        family = texture_family_of(f"{name} {_image_name(image)}")
        key = source.integer(), family
        if key not in self._found:
            self._found[key] = self._written(image, family)
        return self._found[key]

    def _written(self, image: JsonValue, family: str) -> Path | LostImage:
        """Write an image unless its file exists, and return its path, or the reason why that fails."""
        undecoded = _undecoded(image)
        if undecoded is not None:
            return _lost(image, undecoded.message, undecoded)
        try:
            data = _image_bytes(self.document, image)
        except MissingFileError as error:
            return _lost(image, error.message, error)
        suffix = next((s for start, s in SUFFIXES.items() if data.startswith(start)), None)
        if suffix is None or len(data) > MAX_IMAGE_BYTES:
            return _lost(image, f"image of {len(data)} bytes is not a PNG or JPEG of at most {MAX_IMAGE_BYTES}")
        digest = int(hashlib.sha256(data).hexdigest(), 16) % 10**NUM_DIGITS
        path = self.folder / f"{family}_{digest:0{NUM_DIGITS}d}{suffix}"
        try:
            if not path.is_file():
                with write_atomically(path) as file:
                    file.write(data)
            open_texture(path)
        except DatasetError as error:
            return _lost(image, error.message, error)
        except OSError as error:
            raise ConfigError(f"image cannot be written: {error}", file=path, hint="Set HOME_MJX_CACHE.") from None
        return path


def _lost(place: JsonValue, reason: str, error: DatasetError | None = None) -> LostImage:
    """Return an image that is not used, with an error at its place of the class and hint of `error`."""
    kind = type(error) if error else DatasetError
    return LostImage(place, place.error(reason, error.hint if error else None, kind))


def texture_family_of(text: str) -> str:
    """Return the texture family that words of a name tell, by the first word that is one; `texture` if none is.

    Example:
        >>> texture_family_of("M_OakFloor_baseColor"), texture_family_of("atlas0.png")
        ('wood', 'texture')
    """
    words = re.findall(r"[A-Z]?[a-z]+|[A-Z]+", text)
    return next((FAMILY_WORDS[word.lower()] for word in words if word.lower() in FAMILY_WORDS), "texture")


def _undecoded(value: JsonValue) -> DatasetError | None:
    """Return the error of a texture or image that has an extension for a format that is not decoded, else None."""
    try:
        refuse_extensions(value, *sorted(TEXTURE_EXTENSIONS))
    except DatasetError as error:
        return error
    return None


def _image_name(image: JsonValue) -> str:
    """Return the name of an image, else the last part of its path; "" if it has neither."""
    name, uri = image.member("name").data, image.member("uri").data
    if isinstance(name, str):
        return printable(name[:100])
    return printable(uri.rpartition("/")[2][:100]) if isinstance(uri, str) and not uri.startswith("data:") else ""


def _image_bytes(document: GltfDocument, image: JsonValue) -> bytes:
    """Return the bytes of an image file, from its URI or buffer view."""
    view, uri = image.member("bufferView"), image.member("uri")
    if view.has_value:
        return bytes(document.view(view)[0])
    if not uri.has_value:
        raise image.error("image has neither a `uri` nor a `bufferView`")
    return document.read_uri(uri, MAX_IMAGE_BYTES)
