"""Import paths that the documentation of 0.1.0 named and that have moved since: importing one names the new path.

`install` appends one finder to `sys.meta_path`. Python asks it only for modules that nothing else has found, so imports
that work cost nothing. A package that still exists, but that a name has left, takes `attributes_of` as its
`__getattr__`.
"""

import sys
from collections.abc import Callable
from typing import Any, NoReturn

IMAGES = (
    "Camera",
    "Lens",
    "Lit",
    "Preset",
    "camera_rays",
    "depth_points",
    "intrinsics",
    "kinect_depth",
    "render",
    "render_every",
    "render_some",
    "sensor_rgb",
    "world_from_camera",
)
# Old path, a module or a name in one -> the package that exports its names now, and these names.
MOVED: dict[str, tuple[str, tuple[str, ...]]] = {
    "home_mjx.raycast_render.cast": ("home_mjx.raycast_render", ("cast", "occluded")),
    "home_mjx.raycast_render.image": ("home_mjx.raycast_render", IMAGES),
    "home_mjx.scene_compile.bank": ("home_mjx.bank", ("BankSpec", "HouseBank")),
    "home_mjx.scene_compile.compile": ("home_mjx.scene_compile", ("CompileOptions", "compile_house")),
    "home_mjx.scene_compile.compiled": ("home_mjx.schema", ("CompiledHouse", "PortalKind", "Ray", "Semantic")),
    "home_mjx.scene_compile.dataset_job": ("home_mjx.scene_compile", ("Outcome", "Summary", "compile_dataset")),
    "home_mjx.scene_compile.generate": ("home_mjx.datasets", ("build_house", "generate_dataset", "house_id")),
    "home_mjx.scene_compile.house": (
        "home_mjx.schema",
        ("Box", "Ground", "House", "Level", "Light", "Material", "Mesh", "Metadata", "ModelInfo", "Object", "Room"),
    ),
    "home_mjx.scene_compile.house_stream": ("home_mjx.bank", ("HouseStream",)),
    "home_mjx.scene_compile.mjcf.export_mjcf": ("home_mjx.scene_compile", ("export_mjcf",)),
    "home_mjx.scene_compile.mjcf.to_mjcf": ("home_mjx.scene_compile", ("to_mjcf",)),
    "home_mjx.scene_compile.selection": (
        "home_mjx.scene_compile",
        ("SPLITS", "HouseFilter", "select_ids", "split_of"),
    ),
    "home_mjx.scene_compile.semantics.options": ("home_mjx.scene_compile", ("HOME", "SemanticOptions")),
    "home_mjx.scene_compile.suncg": (
        "home_mjx.datasets",
        ("RULES", "Dataset", "LibraryModel", "ReadOptions", "open_dataset", "write_house", "write_library"),
    ),
    "home_mjx.tasks.geodesic": ("home_mjx.navigation", ("distance_field", "goal_fields")),
    "home_mjx.tasks.grid": (
        "home_mjx.navigation",
        ("cell_of", "geodesic_distance", "ground_fields", "place_position", "random_position", "room_of"),
    ),
}


def new_place(old: str) -> str:
    """Where a path of `MOVED` is now.

    Example:
        >>> new_place("home_mjx.scene_compile.house_stream")
        '`home_mjx.scene_compile.house_stream` has moved. Use: from home_mjx.bank import HouseStream'
    """
    package, names = MOVED[old]
    return f"`{old}` has moved. Use: from {package} import {', '.join(names)}"


class MovedFinder:
    """A finder of modules that finds none, but tells where those of `MOVED` are."""

    def find_spec(self, name: str, path: Any = None, target: Any = None) -> None:
        """Raises `ModuleNotFoundError` for a path of `MOVED`."""
        if name in MOVED:
            # Without `name=`: Python replaces the message of `from package import name` where it is that name.
            raise ModuleNotFoundError(new_place(name))


FINDER = MovedFinder()


def install() -> None:
    """Appends the finder to `sys.meta_path`, once."""
    if FINDER not in sys.meta_path:
        sys.meta_path.append(FINDER)


def attributes_of(package: str) -> Callable[[str], NoReturn]:
    """A `__getattr__` for a package: it raises `AttributeError`, and names the new place where there is one.

    Example:
        >>> attributes_of("home_mjx.tasks")("grids")
        Traceback (most recent call last):
        ...
        AttributeError: module 'home_mjx.tasks' has no attribute 'grids'
    """

    def missing(name: str) -> NoReturn:
        old = f"{package}.{name}"
        raise AttributeError(new_place(old) if old in MOVED else f"module {package!r} has no attribute {name!r}")

    return missing
