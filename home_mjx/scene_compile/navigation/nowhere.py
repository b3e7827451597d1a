"""The error of a house in which an agent can stand nowhere: it says what took the space."""

from home_mjx.errors import DatasetError
from home_mjx.scene_compile.navigation.free_space import FreeSpace, NavigationOptions

HINTS = {
    "floor": "Give every room a floor whose faces look up.",
    "walls": "Give every wall a mesh group of its own: `home-mjx inspect --validate` finds walls that are too thick.",
    "furniture": "Take furniture out, use a smaller agent, or leave this house out.",
}


def nowhere_to_stand(between_walls: FreeSpace, options: NavigationOptions) -> DatasetError:
    """An error with the area of the floor, and how much of it walls and then furniture take.

    An area counts as taken where the axis of an agent would be too near.

    Args:
        between_walls: Where an agent could stand if walls were all that is in the way.
        options: Size of the agent and of a cell.
    """
    floor, furniture = (float(m.sum()) * options.cell**2 for m in (between_walls.room >= 0, between_walls.standable))
    walls = floor - furniture
    return DatasetError(
        f"house has no place where an agent of radius {options.agent_radius} m can stand: of {floor:.1f} m² "
        f"of floor, walls take {walls:.1f} m², furniture and doors {furniture:.1f} m²",
        hint=HINTS["floor" if not floor else "walls" if walls > furniture else "furniture"],
    )
