"""Reader of material overrides in house.json and arch.json."""

from home_mjx.datasets.suncg.formats.json_value import JsonValue
from home_mjx.datasets.suncg.formats.texture_paths import TextureLookup
from home_mjx.schema.house import Material

MAX_SLOTS = 1_000  # maximum slots of one model; SUNCG has at most 18


def read_materials(node: JsonValue, shared: JsonValue | None, textures: TextureLookup) -> tuple[Material, ...]:
    """Read the material overrides of a node, by slot position; empty if it has none.

    Of two lists, `materials` takes precedence and the other is ignored.

    Args:
        node: Node with `materials`, with `materialIndices` into the house's list, or with neither.
        shared: Material list of the house.
        textures: Texture lookup of the dataset.

    Raises:
        DatasetError: A texture is missing, an index is out of range, or a value has the wrong type.
    """
    values = node.member("materials")
    if values.has_value:
        return tuple(read_material(value, textures) for value in _few(values))
    indices = node.member("materialIndices")
    if not indices.has_value:
        return ()
    table = shared.entries() if shared and shared.has_value else []
    return tuple(read_material(table[_position(value, len(table))], textures) for value in _few(indices))


def read_material(value: JsonValue, textures: TextureLookup) -> Material:
    """Read one override; an empty one, which changes nothing, if it is null. Errors are those of `read_materials`.

    An empty text as texture or colour is as absent.
    """
    if not value.has_value:
        return Material("")
    name, texture, diffuse = (value.member(key) for key in ("name", "texture", "diffuse"))
    shown = (
        textures.material_fields(texture.text(), lambda: textures.find_required(texture.text(), texture))
        if texture.data
        else {}
    )
    return Material(
        name=name.text() if name.has_value else "",
        diffuse=diffuse.color() if diffuse.data else None,
        **shown,
    )


def _few(value: JsonValue) -> list[JsonValue]:
    """Return the entries of a list; raise `DatasetError` if there are more than `MAX_SLOTS`."""
    entries = value.entries()
    if len(entries) > MAX_SLOTS:
        raise value.error(f"expected at most {MAX_SLOTS} materials, got {len(entries)}")
    return entries


def _position(value: JsonValue, count: int) -> int:
    """Return an index; raise `DatasetError` unless it is from 0 to `count` - 1."""
    index = value.integer()
    if not 0 <= index < count:
        raise value.error(f"expected an index into the house's {count} materials, got {index}")
    return index
