"""Error for a house without standable cells, which reports the areas that walls and furniture take."""

from home_mjx.errors import DatasetError
from home_mjx.scene_compile.navigation.free_space import FreeSpace, NavigationOptions

NO_SPACE_HINTS = {
    "floor": "Ensure that every room has a floor whose faces point up.",
    "walls": "Put every wall in a mesh group of its own: `home-mjx inspect --validate` finds walls that are too thick.",
    "furniture": "Remove furniture, use a smaller agent, or leave this house out.",
}


def no_free_space_error(between_walls: FreeSpace, options: NavigationOptions) -> DatasetError:
    """Return an error with the area of the floor and the areas that walls and furniture take.

    An area counts as taken if the axis of an agent would be too close to an obstacle.

    Args:
        between_walls: Free space with walls as the only obstacles.
        options: Sizes of the agent and of a cell.
    """
    floor, furniture = (float(m.sum()) * options.cell**2 for m in (between_walls.room >= 0, between_walls.standable))
    walls = floor - furniture
    return DatasetError(
        f"house has no place where an agent of radius {options.agent_radius} m can stand: of {floor:.1f} m² "
        f"of floor, walls take {walls:.1f} m², furniture and doors {furniture:.1f} m²",
        hint=NO_SPACE_HINTS["floor" if not floor else "walls" if walls > furniture else "furniture"],
    )
