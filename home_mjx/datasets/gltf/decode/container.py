"""Files of a glTF document: JSON or GLB, its buffers, and data from URIs, read within bounds and below its folder."""

import base64
import binascii
import json
import re
import struct
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import unquote_to_bytes

from home_mjx.core.files import read_bytes, resolve_below
from home_mjx.datasets.suncg.formats.json_value import JsonValue, Location
from home_mjx.errors import DatasetError

MAX_FILE_BYTES = 1 << 30  # [bytes], maximum size of a GLB or of one buffer
MAX_JSON_BYTES = (
    1 << 24
)  # [bytes], maximum size of the JSON part without embedded files; its values take many times as much memory
GLB_MAGIC, JSON_CHUNK, BINARY_CHUNK = b"glTF", 0x4E4F534A, 0x004E4942
URI_SCHEME = re.compile(r"[A-Za-z][A-Za-z0-9+.-]*:")
# Extensions that the reader decodes; a file that requires any other one is refused by name.
SUPPORTED_EXTENSIONS = frozenset(
    {
        "EXT_mesh_gpu_instancing",
        "KHR_draco_mesh_compression",
        "KHR_lights_punctual",
        "KHR_materials_emissive_strength",
        "KHR_materials_ior",
        "KHR_materials_pbrSpecularGlossiness",
        "KHR_materials_specular",
        "KHR_materials_transmission",
        "KHR_materials_unlit",
        "KHR_mesh_quantization",
        "KHR_node_visibility",
        "KHR_texture_transform",
    }
)
# Extensions without which a scene has the same shapes and base colours; `inspect` lists those that a file uses.
IGNORED_EXTENSIONS = frozenset(
    {
        "KHR_animation_pointer",
        "KHR_materials_anisotropy",
        "KHR_materials_clearcoat",
        "KHR_materials_diffuse_transmission",
        "KHR_materials_dispersion",
        "KHR_materials_iridescence",
        "KHR_materials_sheen",
        "KHR_materials_variants",
        "KHR_materials_volume",
        "KHR_xmp_json_ld",
    }
)
# Extensions for formats of images that are not decoded; the material's colour replaces such textures.
TEXTURE_EXTENSIONS = frozenset(
    {"EXT_texture_avif", "EXT_texture_webp", "KHR_texture_basisu", "KHR_texture_ktx", "MSFT_texture_dds"}
)
MESHOPT = ("EXT_meshopt_compression", "KHR_meshopt_compression")
DATA_TEXT = re.compile(rb'"data:[^"]*"')
REMEDIES = {
    **dict.fromkeys(MESHOPT, "Decompress it, such as with `gltf-transform dequantize` or `gltfpack -noq`."),
    **dict.fromkeys(
        ("EXT_texture_avif", "EXT_texture_webp", "MSFT_texture_dds"),
        "Convert its images to PNG, such as with `gltf-transform png`.",
    ),
    **dict.fromkeys(
        ("KHR_texture_basisu", "KHR_texture_ktx"),
        "Convert its images to PNG, such as with `gltf-transform ktxdecompress`.",
    ),
}


@dataclass(frozen=True)
class GltfDocument:
    """A parsed glTF document.

    Attributes:
        path: Its file; all others must be below the file's folder.
        root: The JSON document.
        chunk: Binary chunk of a GLB; None without one.
    """

    path: Path
    root: JsonValue
    chunk: bytes | None = None
    _buffers: dict[int, bytes] = field(default_factory=dict, repr=False)
    _lists: dict[str, list[JsonValue]] = field(default_factory=dict, repr=False)

    def items(self, key: str) -> list[JsonValue]:
        """Return the entries of a top-level list, such as `meshes`, listed once; [] if it is absent."""
        if key not in self._lists:
            value = self.root.member(key)
            self._lists[key] = value.entries() if value.has_value else []
        return self._lists[key]

    def item(self, key: str, index: JsonValue) -> JsonValue:
        """Return the entry of a top-level list that another value names by its index.

        Raises:
            DatasetError: The value is not an index into the list.
        """
        items, number = self.items(key), index.integer()
        if not 0 <= number < len(items):
            raise index.error(f"expected an index into the {len(items)} `{key}`, got {number}")
        return items[number]

    def buffer(self, index: JsonValue) -> bytes:
        """Return the bytes of a buffer, read once.

        Raises:
            MissingFileError: Its file is missing.
            DatasetError: The index is out of range, or the buffer is shorter than its `byteLength`.
        """
        value, number = self.item("buffers", index), index.integer()
        if number not in self._buffers:
            uri = value.member("uri")
            if not uri.has_value and (self.chunk is None or number):
                raise value.error("buffer has neither a `uri` nor the binary chunk of a GLB")
            data = self.read_uri(uri) if uri.has_value else self.chunk or b""
            length = value.member("byteLength").integer()
            if not 0 <= length <= len(data):
                raise value.error(f"buffer has {len(data)} bytes, its `byteLength` is {length}")
            self._buffers[number] = data[:length]
        return self._buffers[number]

    def view(self, index: JsonValue) -> tuple[memoryview, int | None]:
        """Return the bytes of a buffer view, and its stride [bytes]; None: elements are adjacent.

        Raises:
            DatasetError: The view reaches beyond its buffer.
        """
        value = self.item("bufferViews", index)
        if self._is_placeholder(value.member("buffer")):
            refuse_extensions(value, *MESHOPT)
        data = self.buffer(value.member("buffer"))
        start, length = offset_of(value), value.member("byteLength").integer()
        if length < 0 or start + length > len(data):
            raise value.error(f"view ends at byte {start + length} of a buffer of {len(data)} bytes")
        stride = value.member("byteStride")
        if stride.has_value and not 4 <= stride.integer() <= 252:
            raise stride.error(f"expected a stride of 4 to 252 bytes, got {stride.integer()}")
        return memoryview(data)[start : start + length], stride.integer() if stride.has_value else None

    def _is_placeholder(self, index: JsonValue) -> bool:
        """Return whether a buffer may have no data, since its views are compressed by meshopt."""
        if any(value.data in MESHOPT for value in self.items("extensionsRequired")):
            return True
        extensions = self.item("buffers", index).member("extensions")
        stated = [extensions.member(name) for name in MESHOPT] if extensions.has_value else []
        return any(value.has_value and value.member("fallback").flag() for value in stated)

    def read_uri(self, uri: JsonValue, max_bytes: int = MAX_FILE_BYTES) -> bytes:
        """Return the data of a `data:` URI, or of a file below the document's folder; errors as in `uri_path`."""
        if uri.text().startswith("data:"):
            return _decode_data(uri)
        return read_bytes(uri_path(self.path.parent, uri), f"`{uri.element}` of {self.path} names it.", max_bytes)


def offset_of(value: JsonValue) -> int:
    """Return the `byteOffset` of an accessor or a view [bytes]; 0 if it is absent; negative ones are errors."""
    offset = value.member("byteOffset")
    if offset.has_value and offset.integer() < 0:
        raise offset.error(f"expected an offset of at least 0, got {offset.integer()}")
    return offset.integer() if offset.has_value else 0


def refuse_extensions(value: JsonValue, *names: str) -> None:
    """Raise `DatasetError` if a value has one of these extensions, which hold data that the reader cannot decode."""
    extensions = value.member("extensions")
    for name in names:
        if extensions.has_value and extensions.member(name).has_value:
            raise extensions.error(f"extension `{name}` is not supported", REMEDIES.get(name))


def uri_path(folder: Path, uri: JsonValue) -> Path:
    """Return the path of a file that a relative URI names.

    Raises:
        DatasetError: The URI has a scheme, is absolute, or leads out of the folder, also by a symbolic link.
    """
    text = unquote_to_bytes(uri.text()).decode("utf-8", "replace")
    hint = "Put the file into the folder of the document, and name it by a relative path."
    if URI_SCHEME.match(text) or text.startswith(("/", "\\")) or "\0" in text or not text:
        raise uri.error(f"expected a relative path, got `{text[:60]}`", hint)
    path = resolve_below(folder, folder, text)
    if path is None or not path.resolve().is_relative_to(folder.resolve()):
        raise uri.error(f"`{text[:60]}` leads out of the folder of the document", hint)
    return path


def _decode_data(uri: JsonValue) -> bytes:
    """Return the bytes of a `data:` URI."""
    head, comma, body = uri.text().partition(",")
    if not comma:
        raise uri.error("data URI has no comma")
    try:
        return base64.b64decode(body, validate=True) if head.endswith(";base64") else unquote_to_bytes(body)
    except (binascii.Error, ValueError) as error:
        raise uri.error(f"data URI is not base64: {error}") from None


def read_document(path: Path, tolerated: frozenset[str] = frozenset()) -> GltfDocument:
    """Read a `.gltf` or `.glb` file; its content decides which it is.

    Args:
        path: The file.
        tolerated: Extensions that may be required although they are not decoded, such as of textures.

    Raises:
        MissingFileError: The file is missing.
        DatasetError: It is neither, of another version than 2, or requires an unsupported extension.
    """
    data = read_bytes(path, max_bytes=MAX_FILE_BYTES)
    text, chunk = _split_glb(path, data) if data[:4] == GLB_MAGIC else (data, None)
    document = GltfDocument(path, _parse(path, text), chunk)
    asset = document.root.member("asset")
    version, minimum = asset.member("version"), asset.member("minVersion")
    if version.text().split(".")[0] != "2":
        raise version.error(f"expected glTF 2, got version `{version.text()[:20]}`", "Export it as glTF 2.0.")
    if minimum.has_value and minimum.text() != "2.0":
        raise minimum.error(f"file needs a reader of glTF `{minimum.text()[:20]}`", "Export it as glTF 2.0.")
    for required in document.items("extensionsRequired"):
        if required.text() not in SUPPORTED_EXTENSIONS | IGNORED_EXTENSIONS | tolerated:
            message = f"file requires the extension `{required.text()[:60]}`, which is not supported"
            raise required.error(message, REMEDIES.get(required.text(), "Export the file without it."))
    return document


def _split_glb(path: Path, data: bytes) -> tuple[bytes, bytes | None]:
    """Return the JSON chunk and the binary chunk of a GLB; chunks of other kinds are skipped."""
    if len(data) < 12 or (header := struct.unpack_from("<II", data, 4))[0] != 2 or header[1] > len(data):
        raise DatasetError("header of the GLB does not fit its version or size", file=path, hint="Fetch it again.")
    chunks, position = {}, 12
    while position + 8 <= header[1]:
        length, kind = struct.unpack_from("<II", data, position)
        if position + 8 + length > header[1]:
            raise Location(path, f"byte {position}").error("chunk of the GLB ends beyond the file")
        chunks.setdefault(kind, data[position + 8 : position + 8 + length])
        position += 8 + length
    if JSON_CHUNK not in chunks:
        raise DatasetError("GLB has no JSON chunk", file=path, hint="Fetch or export it again.")
    return chunks[JSON_CHUNK], chunks.get(BINARY_CHUNK)


def _parse(path: Path, data: bytes) -> JsonValue:
    """Parse the JSON part of a document."""
    length = len(data)
    if length > MAX_JSON_BYTES:
        length -= sum(found.end() - found.start() for found in DATA_TEXT.finditer(data))
    if length > MAX_JSON_BYTES:
        raise DatasetError(
            f"JSON part has {length} bytes without embedded files, at most {MAX_JSON_BYTES} are read", file=path
        )
    try:
        return JsonValue(path, "", json.loads(data.decode("utf-8-sig")))
    except (ValueError, RecursionError) as error:
        raise DatasetError(f"not a glTF document: {error}", file=path, hint="Fetch or export it again.") from None
