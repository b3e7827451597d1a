"""What everything in a house is, looks like and stands next to: categories, colours, materials, sizes, relations, text.

Names are imported on first use: the compiler's modules need the rows of this package before its engine can be imported.
"""

import importlib
from typing import Any

_PUBLIC = {
    "HOME": "options",
    "HouseSemantics": "types",
    "ObjectSemantics": "types",
    "PartSemantics": "types",
    "Relation": "relations",
    "RoomSemantics": "types",
    "SemanticOptions": "options",
    "Viewpoint": "relations",
    "describe_object": "describe",
    "house_semantics": "engine",
    "names_of": "vocabulary",
    "number_of": "vocabulary",
    "semantic_row": "rows",
    "vocabularies": "vocabulary",
}

__all__ = list(_PUBLIC)  # pyright: ignore[reportUnsupportedDunderAll]


def __getattr__(name: str) -> Any:
    if name not in _PUBLIC:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f"{__name__}.{_PUBLIC[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
