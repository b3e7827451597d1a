"""Listing of a house's missing materials, and a short summary of all its fallbacks."""

from collections import Counter
from collections.abc import Iterator, Sequence

from home_mjx.schema.house import FALLBACK_KINDS, Fallback, House, Level, Material

PLURALS = {"material library": "material libraries", "room mesh": "room meshes", "metadata row": "metadata rows"}
COLOR_WORDS, LIBRARY_WORDS = "the material's colour", "grey materials"


def list_missing_materials(house: House) -> list[Fallback]:
    """Return a `Fallback` per texture and material library that the dataset lacks, in order of its first user.

    Overrides of nodes come before the meshes of models, rooms and grounds.
    """
    found: dict[tuple[str, str], Fallback] = {}
    for owner, material in _materials(house):
        if material.missing_file:
            library = material.missing_file.endswith(".mtl")
            kind = "material library" if library else "texture"
            taken = LIBRARY_WORDS if library else COLOR_WORDS
            found.setdefault((kind, material.missing_file), Fallback(kind, material.missing_file, owner, taken))
    return list(found.values())


def _materials(house: House) -> Iterator[tuple[str, Material]]:
    """Yield (owner, material) for all materials: owners are element paths of overrides or file names of meshes."""
    for level in house.levels:
        for node in (*level.objects, *level.boxes):
            yield from ((node.path, material) for material in node.materials)
    meshes = [*house.models.values(), *(mesh for level in house.levels for mesh in _parts(level))]
    for mesh in meshes:
        yield from ((mesh.path.name, material) for material in mesh.materials)


def _parts(level: Level) -> Iterator:
    """Yield the existing meshes of a level's rooms and grounds."""
    rooms = [part for room in level.rooms for part in (room.floor, room.ceiling, room.walls)]
    yield from (part for part in (*rooms, *(ground.mesh for ground in level.grounds)) if part is not None)


def count_fallbacks(fallbacks: Sequence[Fallback]) -> dict[str, int]:
    """Count the fallbacks by kind, in the order of `FALLBACK_KINDS`; 0 for kinds without any.

    Example:
        >>> count_fallbacks([Fallback("texture", "wood_8", "122.obj", "the material's colour")])["texture"]
        1
    """
    found = Counter(item.kind for item in fallbacks)
    return {kind: found[kind] for kind in FALLBACK_KINDS}


def describe_fallbacks(fallbacks: Sequence[Fallback]) -> str:
    """Describe the counts by kind, for a message; "" if there are none.

    Example:
        >>> describe_fallbacks(
        ...     [Fallback("texture", "wood_8", "122.obj", ""), Fallback("texture", "wood_9", "122.obj", "")]
        ... )
        '2 textures'
    """
    counts = count_fallbacks(fallbacks).items()
    return ", ".join(
        f"{count} {PLURALS.get(kind, f'{kind}s') if count > 1 else kind}" for kind, count in counts if count
    )
