"""From a house as the dataset says it to the arrays that the engines need."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Float

from home_mjx.scene_compile.architecture import Architecture, build_architecture
from home_mjx.scene_compile.boxes import BoxSet, join
from home_mjx.scene_compile.colliders import (
    ColliderOptions,
    floor_colliders,
    keep_reachable,
    object_colliders,
    passable_leaves,
    passages,
    wall_colliders,
    without_hidden,
)
from home_mjx.scene_compile.compiled import CompiledHouse, Instances, Model, Rooms
from home_mjx.scene_compile.house import House, Metadata
from home_mjx.scene_compile.materials import SurfaceRows, material_table
from home_mjx.scene_compile.movables import Candidate, MovableOptions, choose_movables, make_bodies
from home_mjx.scene_compile.navigation import FreeSpace, NavigationOptions, build_navigation, free_space
from home_mjx.scene_compile.objects import Placed, place_objects
from home_mjx.scene_compile.pack_tables import ground_floor
from home_mjx.scene_compile.planes import build_planes
from home_mjx.scene_compile.rooms import extract_rooms, ground_offset
from home_mjx.scene_compile.semantics import semantic_row
from home_mjx.scene_compile.semantics.engine import describe_house
from home_mjx.scene_compile.semantics.options import SemanticOptions
from home_mjx.scene_compile.semantics.table import with_meaning
from home_mjx.scene_compile.top_tree import instance_box, top_tree


@dataclass(frozen=True)
class CompileOptions:
    """How a house is compiled; part of the cache's key."""

    navigation: NavigationOptions = field(default_factory=NavigationOptions)
    colliders: ColliderOptions = field(default_factory=ColliderOptions)
    movables: MovableOptions = field(default_factory=MovableOptions)
    semantics: SemanticOptions = field(default_factory=SemanticOptions)


DEFAULT_OPTIONS = CompileOptions()


def compile_house(house: House, metadata: Metadata, options: CompileOptions = DEFAULT_OPTIONS) -> CompiledHouse:
    """Compiles one house: Z up, its ground floor's rooms around x = y = 0.

    Args:
        house: What the dataset says.
        metadata: Categories of its models.
        options: Sizes, counts and limits.

    Raises:
        DatasetError: The house has no room with a mesh, or nowhere to stand.

    Example:
        >>> dataset = open_dataset("datasets/demo")  # doctest: +SKIP
        >>> compiled = compile_house(dataset.load_house(dataset.house_ids[0]), dataset.metadata)  # doctest: +SKIP
        >>> compiled.report["rooms"]  # doctest: +SKIP
        5
    """
    offset = ground_offset(house)
    rooms = extract_rooms(house, offset)
    shell = build_architecture(house, rooms, offset)
    objects = place_objects(house, metadata, rooms, offset)
    solid = _make_solid(shell, rooms, objects, options)
    rows = SurfaceRows()
    rows.add(shell.surfaces)
    slot = {c.item.object_id: i for i, c in enumerate(solid.movable)}
    instances = _instances(shell, objects, rows, slot)
    models = {m.key: m for m in (shell.model, *(o.model for o in objects))}
    meaning = describe_house(house, shell, objects, rooms, metadata, options.semantics)
    semantics = np.concatenate([shell.semantics, *(_object_row(o, slot)[None] for o in objects)])
    return CompiledHouse(
        id=house.id,
        offset=offset,
        box=_bounds(instances, models),
        instances=instances,
        top=top_tree(instances, models),
        materials=material_table(rows.surfaces),
        semantics=with_meaning(semantics, meaning),
        colliders=solid.static.colliders(),
        bodies=make_bodies(solid.movable, {o.object_id: i + 1 for i, o in enumerate(objects)}),
        planes=build_planes(shell, rooms),
        rooms=rooms,
        navigation=build_navigation(house.id, rooms, solid.space, options.navigation),
        models=models,
        report=_report(house, shell, objects, solid),
    )


@dataclass(frozen=True)
class _Solid:
    """What of a house stops bodies."""

    static: BoxSet
    movable: list[Candidate]
    space: FreeSpace
    report: dict[str, int]


def _make_solid(shell: Architecture, rooms: Rooms, objects: Sequence[Placed], options: CompileOptions) -> _Solid:
    floor, level, limits = ground_floor(rooms), int(rooms.level.min()), options.colliders
    walls = join([wall_colliders(shell, limits), floor_colliders(rooms, floor, limits)])
    walls = keep_reachable(walls, floor, limits)
    fitted = {o.object_id: object_colliders(o, floor, limits) for o in objects}
    boxes = {i: found for i, (found, _) in fitted.items()}
    leaves = [leaf for _, found in fitted.values() for leaf in found if len(leaf)]
    movable, stuck = choose_movables(objects, boxes, join([walls, *leaves]), floor, level, options.movables)
    moving = {c.item.object_id for c in movable}
    static = join([walls, *(b for i, b in boxes.items() if i not in moving)])
    obstacles = join([static, *(c.box for c in movable)])

    def space(leaf_boxes: BoxSet) -> FreeSpace:
        return free_space(rooms, join([obstacles, leaf_boxes]), passages(objects), options.navigation)

    kept = passable_leaves(leaves, lambda boxes: space(boxes).free.sum() * options.navigation.cell**2)
    counts = {"movable_but_stuck": stuck, "leaves_not_solid": len(leaves) - len(kept)}
    return _Solid(without_hidden(join([static, *kept])), movable, space(join(kept)), counts)


def _instances(shell: Architecture, objects: Sequence[Placed], rows: SurfaceRows, slot: Mapping[int, int]) -> Instances:
    return Instances(
        model=(shell.model.key, *(o.model.key for o in objects)),
        pose=np.stack([np.eye(3, 4), *(o.pose for o in objects)]),
        object_id=np.array([-1, *(o.object_id for o in objects)], np.int32),
        material=np.array([0, *(rows.add(o.surfaces) for o in objects)], np.int32),
        semantic=np.array([0, *(len(shell.semantics) + np.arange(len(objects)))], np.int32),
        body=np.array([-1, *(slot.get(o.object_id, -1) for o in objects)], np.int32),
    )


def _object_row(item: Placed, slot: Mapping[int, int]) -> np.ndarray:
    return semantic_row(
        item.info.fine,
        item.info.coarse,
        item.info.nyu40,
        object_id=item.object_id,
        room=item.room,
        level=item.level,
        movable=slot.get(item.object_id, -1),
    )


def _bounds(instances: Instances, models: Mapping[str, Model]) -> Float[np.ndarray, "2 3"]:
    boxes = np.array([instance_box(p, models[k].box) for p, k in zip(instances.pose, instances.model, strict=True)])
    return np.stack([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])


def _report(house: House, shell: Architecture, objects: Sequence[Placed], solid: _Solid) -> dict[str, int]:
    """Counts: of the input as it is and of what became of it."""
    return {
        "levels": len(house.levels),
        "rooms": sum(len(level.rooms) for level in house.levels),
        "objects": len(objects),
        "objects_outside": sum(o.room < 0 for o in objects),
        "architecture_parts": shell.num_meshes,
        "surfaces": len(shell.parts),
        "partitions": int(shell.partition.max()) + 1,
        "models": len({o.model.key for o in objects}),
        "triangles": sum(len(o.model.triangle) for o in objects) + len(shell.model.triangle),
        "colliders": len(solid.static),
        "bodies": len(solid.movable),
        "problems": len(house.problems),
        **solid.report,
    }
