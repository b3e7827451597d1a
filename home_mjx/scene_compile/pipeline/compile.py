"""Compiler from a house as read from the dataset to the arrays of the engines."""

from dataclasses import dataclass, field, replace
from typing import get_type_hints

from home_mjx.core.checks import check_type
from home_mjx.datasets.base import ReadOptions
from home_mjx.scene_compile.architecture.rooms import HouseFrame, find_frame
from home_mjx.scene_compile.architecture.shell import BuildingShell, build_shell
from home_mjx.scene_compile.collision.colliders import ColliderOptions
from home_mjx.scene_compile.collision.movables import MovableOptions
from home_mjx.scene_compile.lighting.lights import LightOptions, build_lights
from home_mjx.scene_compile.navigation.build import build_navigation
from home_mjx.scene_compile.navigation.free_space import NavigationOptions
from home_mjx.scene_compile.navigation.reach import UnreachableStorey, find_unreachable_storeys
from home_mjx.scene_compile.objects.doorways import shut_outer_doors
from home_mjx.scene_compile.objects.fronts import ArticulationOptions, keep_largest_fronts
from home_mjx.scene_compile.objects.placed_objects import PlacedObject, place_objects
from home_mjx.scene_compile.pipeline.assemble import assemble, build_surfaces
from home_mjx.scene_compile.pipeline.levels import LevelGeometry, build_levels
from home_mjx.scene_compile.pipeline.limits import add_house_file, check_counts
from home_mjx.scene_compile.semantics.appearance import SemanticOptions
from home_mjx.scene_compile.semantics.engine import describe_house
from home_mjx.scene_compile.semantics.table import build_semantic_rows
from home_mjx.schema.compiled import CompiledHouse, HouseNavigation
from home_mjx.schema.house import House, Metadata


@dataclass(frozen=True)
class CompileOptions:
    """Options of reading and compiling a house; part of the cache key. `compile_house` ignores `read`.

    Raises:
        ConfigError: A value is not of its field's type.
    """

    navigation: NavigationOptions = field(default_factory=NavigationOptions)
    colliders: ColliderOptions = field(default_factory=ColliderOptions)
    movables: MovableOptions = field(default_factory=MovableOptions)
    semantics: SemanticOptions = field(default_factory=SemanticOptions)
    lights: LightOptions = field(default_factory=LightOptions)
    articulation: ArticulationOptions = field(default_factory=ArticulationOptions)
    read: ReadOptions = field(default_factory=ReadOptions)

    def __post_init__(self) -> None:
        for name, kind in get_type_hints(CompileOptions).items():
            check_type(name, getattr(self, name), kind)


DEFAULT_OPTIONS = CompileOptions()


def compile_house(house: House, metadata: Metadata, options: CompileOptions = DEFAULT_OPTIONS) -> CompiledHouse:
    """Compile one house: Z up, its ground-floor rooms centred at x = y = 0.

    Args:
        house: House as read from the dataset.
        metadata: Categories of its models.
        options: Sizes, counts and limits.

    Raises:
        DatasetError: The house has no room with a mesh or no standable cell, or exceeds the `limits`; or a texture
            cannot be read.

    Example:
        >>> dataset = open_dataset("datasets/demo")  # doctest: +SKIP
        >>> compiled = compile_house(dataset.load_house(dataset.house_ids[0]), dataset.metadata)  # doctest: +SKIP
        >>> compiled.report["rooms"]  # doctest: +SKIP
        5
    """
    check_counts(house)
    with add_house_file(house):
        return _compiled(house, metadata, options)


def find_storeys_without_access(
    house: House, metadata: Metadata, options: CompileOptions = DEFAULT_OPTIONS
) -> dict[UnreachableStorey, tuple[str, ...]]:
    """Return the storeys that agents cannot reach, each with the node ids of the stairs that begin or end there.

    Arguments and errors are those of `compile_house`.
    """
    check_counts(house)
    with add_house_file(house):
        _, _, objects, levels, navigation = _geometry(house, metadata, options)
    names = {o.object_id: o.node.id for o in objects}
    lost = find_unreachable_storeys(levels.spaces, navigation.region, levels.stairs, navigation.cell)
    return {one: tuple(names[stairs] for stairs in one.stairs) for one in lost}


def _compiled(house: House, metadata: Metadata, options: CompileOptions) -> CompiledHouse:
    """Run the stages of the compiler in order; each returns one record."""
    frame, shell, objects, levels, navigation = _geometry(house, metadata, options)
    surfaces = build_surfaces(frame, shell, objects)
    lights = build_lights(objects, frame.rooms, options.lights)
    meaning = describe_house(frame, shell, objects, metadata, options.semantics)
    semantics = build_semantic_rows(shell, objects, levels.bodies, meaning)
    return assemble(frame, shell, objects, levels, navigation, surfaces, lights, semantics)


def _geometry(
    house: House, metadata: Metadata, options: CompileOptions
) -> tuple[HouseFrame, BuildingShell, list[PlacedObject], LevelGeometry, HouseNavigation]:
    """Run the stages up to navigation data."""
    house, num_joints = keep_largest_fronts(house, metadata, options.articulation.max_fronts)
    frame = find_frame(house)
    shell = build_shell(frame)
    objects = shut_outer_doors(place_objects(frame, metadata), frame.rooms)
    levels = build_levels(frame, shell, objects, options.colliders, options.movables, options.navigation)
    levels = replace(levels, report={**levels.report, "shut_joints": num_joints - int(levels.doors.is_front.sum())})
    navigation = build_navigation(
        house.id,
        frame.rooms,
        levels.spaces,
        options.navigation,
        levels.doorways,
        levels.stairs,
        levels.leaves,
        levels.open_leaves,
    )
    return frame, shell, objects, levels, navigation
