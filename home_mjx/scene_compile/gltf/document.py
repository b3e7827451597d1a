"""A glTF document in memory: its JSON, its binary chunk, and the file of both."""

import json
import struct
from dataclasses import dataclass, field
from typing import Any

import numpy as np

COMPONENTS = {np.dtype(np.float32): 5126, np.dtype(np.uint32): 5125}
VIEW_TARGETS = {np.dtype(np.float32): 34962, np.dtype(np.uint32): 34963}  # vertices, indices
SHAPES = {1: "SCALAR", 2: "VEC2", 3: "VEC3"}
JSON_CHUNK, BINARY_CHUNK = 0x4E4F534A, 0x004E4942


@dataclass
class DocumentWriter:
    """Writer of a GLB file.

    Attributes:
        root: The JSON document; `add` appends to its lists.
        chunk: Binary chunk.
    """

    root: dict[str, Any] = field(default_factory=lambda: {"asset": {"version": "2.0", "generator": "home_mjx"}})
    chunk: bytearray = field(default_factory=bytearray)

    def add(self, key: str, value: dict[str, Any]) -> int:
        """Append a value to a top-level list, such as `nodes`, and return its index."""
        self.root.setdefault(key, []).append(value)
        return len(self.root[key]) - 1

    def use_extension(self, name: str) -> None:
        """List an extension that the document uses, once."""
        listed = self.root.setdefault("extensionsUsed", [])
        if name not in listed:
            listed.append(name)

    def add_view(self, data: bytes, target: int | None = None) -> int:
        """Append bytes to the chunk, and return the index of their buffer view; `target` is one of `VIEW_TARGETS`."""
        self.chunk += bytes(-len(self.chunk) % 4)
        view = {"buffer": 0, "byteOffset": len(self.chunk), "byteLength": len(data)}
        view |= {} if target is None else {"target": target}
        self.chunk += data
        return self.add("bufferViews", view)

    def add_accessor(self, values: np.ndarray, has_bounds: bool = False) -> int:
        """Append an array of float32 or uint32 with a row per element, and return the index of its accessor."""
        width = 1 if values.ndim == 1 else values.shape[1]
        found = {
            "bufferView": self.add_view(np.ascontiguousarray(values).tobytes(), VIEW_TARGETS[values.dtype]),
            "componentType": COMPONENTS[values.dtype],
            "count": len(values),
            "type": SHAPES[width],
        }
        if has_bounds:
            found |= {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}
        return self.add("accessors", found)

    def glb(self) -> bytes:
        """Return the content of the file."""
        self.chunk += bytes(-len(self.chunk) % 4)
        text = json.dumps(self.root | {"buffers": [{"byteLength": len(self.chunk)}]}, allow_nan=False).encode()
        text += b" " * (-len(text) % 4)
        parts = struct.pack("<II", len(text), JSON_CHUNK), text
        parts = (*parts, struct.pack("<II", len(self.chunk), BINARY_CHUNK), bytes(self.chunk))
        return b"".join((b"glTF", struct.pack("<II", 2, 12 + sum(map(len, parts))), *parts))
