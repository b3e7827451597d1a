"""Reader of material overrides in house.json and arch.json."""

from home_mjx.datasets.suncg.formats.element import Value
from home_mjx.datasets.suncg.formats.texture_paths import Textures
from home_mjx.schema.house import Material

MAX_SLOTS = 1_000  # maximum slots of one model; SUNCG has at most 18


def read_materials(node: Value, shared: Value | None, textures: Textures) -> tuple[Material, ...]:
    """Read the material overrides of a node, by slot position.

    Args:
        node: Node with `materials`, with `materialIndices` into the house's list, or with neither.
        shared: Material list of the house.
        textures: Texture lookup of the dataset.

    Raises:
        DatasetError: A texture is missing, or a value has the wrong type.
    """
    values = node.member("materials")
    if values.present:
        return tuple(read_material(value, textures) for value in _few(values))
    indices = node.member("materialIndices")
    if not indices.present:
        return ()
    table = shared.entries() if shared and shared.present else []
    return tuple(read_material(table[_position(value, len(table))], textures) for value in _few(indices))


def read_material(value: Value, textures: Textures) -> Material:
    """Read one override; raise `DatasetError` like `read_materials`."""
    if not value.present:
        return Material("")
    name, texture, diffuse = (value.member(key) for key in ("name", "texture", "diffuse"))
    shown = (
        textures.of_material(texture.text(), lambda: textures.named(texture.text(), texture)) if texture.data else {}
    )
    return Material(
        name=name.text() if name.present else "",
        diffuse=diffuse.color() if diffuse.data else None,
        **shown,
    )


def _few(value: Value) -> list[Value]:
    entries = value.entries()
    if len(entries) > MAX_SLOTS:
        raise value.error(f"expected at most {MAX_SLOTS} materials, got {len(entries)}")
    return entries


def _position(value: Value, count: int) -> int:
    index = value.integer()
    if not 0 <= index < count:
        raise value.error(f"expected an index into the house's {count} materials, got {index}")
    return index
