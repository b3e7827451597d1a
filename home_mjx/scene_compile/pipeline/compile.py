"""From a house as the dataset says it to the arrays that the engines need."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import get_type_hints

import numpy as np
from jaxtyping import Float

from home_mjx.core.checks import check_type
from home_mjx.datasets.options import ReadOptions
from home_mjx.scene_compile.architecture.mirror_planes import build_planes
from home_mjx.scene_compile.architecture.rooms import extract_rooms, ground_offset
from home_mjx.scene_compile.architecture.shell import Shell, build_shell
from home_mjx.scene_compile.collision.colliders import ColliderOptions, leaf_box
from home_mjx.scene_compile.collision.movables import MovableOptions, make_bodies
from home_mjx.scene_compile.geometry.instance_tree import instance_box, top_tree
from home_mjx.scene_compile.lighting.gloss import gloss_table
from home_mjx.scene_compile.lighting.lights import LightOptions, build_lights
from home_mjx.scene_compile.materials.surface import SurfaceRows, material_table
from home_mjx.scene_compile.navigation.free_space import NavigationOptions, build_navigation
from home_mjx.scene_compile.objects.doors import make_doors, place_leaf
from home_mjx.scene_compile.objects.place import PlacedObject, place_objects
from home_mjx.scene_compile.pipeline.limits import blaming, check_counts, check_extent, check_walls
from home_mjx.scene_compile.pipeline.solid import Solid, make_solid
from home_mjx.scene_compile.pipeline.storeys import find_storeys
from home_mjx.scene_compile.semantics.engine import describe_house
from home_mjx.scene_compile.semantics.looks.options import SemanticOptions
from home_mjx.scene_compile.semantics.table import with_meaning
from home_mjx.schema.compiled import CompiledHouse, Doors, Instances, Model
from home_mjx.schema.house import House, Metadata
from home_mjx.schema.semantic import semantic_row


@dataclass(frozen=True)
class CompileOptions:
    """How a house is read and compiled; part of the cache's key. `compile_house` gets houses that are read already."""

    navigation: NavigationOptions = field(default_factory=NavigationOptions)
    colliders: ColliderOptions = field(default_factory=ColliderOptions)
    movables: MovableOptions = field(default_factory=MovableOptions)
    semantics: SemanticOptions = field(default_factory=SemanticOptions)
    lights: LightOptions = field(default_factory=LightOptions)
    read: ReadOptions = field(default_factory=ReadOptions)

    def __post_init__(self) -> None:
        for name, kind in get_type_hints(CompileOptions).items():
            check_type(name, getattr(self, name), kind)


DEFAULT_OPTIONS = CompileOptions()


def compile_house(house: House, metadata: Metadata, options: CompileOptions = DEFAULT_OPTIONS) -> CompiledHouse:
    """Compiles one house: Z up, its ground floor's rooms around x = y = 0.

    Args:
        house: What the dataset says.
        metadata: Categories of its models.
        options: Sizes, counts and limits.

    Raises:
        DatasetError: The house has no room with a mesh, nowhere to stand, or is larger than `limits` allow.

    Example:
        >>> dataset = open_dataset("datasets/demo")  # doctest: +SKIP
        >>> compiled = compile_house(dataset.load_house(dataset.house_ids[0]), dataset.metadata)  # doctest: +SKIP
        >>> compiled.report["rooms"]  # doctest: +SKIP
        5
    """
    check_counts(house)
    with blaming(house):
        return _compiled(house, metadata, options)


def _compiled(house: House, metadata: Metadata, options: CompileOptions) -> CompiledHouse:
    offset = ground_offset(house)
    rooms = extract_rooms(house, offset)
    check_extent(house, rooms, options.navigation.cell)
    shell = build_shell(house, rooms, offset)
    check_walls(house, shell)
    objects = place_objects(house, metadata, rooms, offset)
    solid = make_solid(shell, rooms, objects, options.colliders, options.movables, options.navigation)
    storeys = find_storeys(shell, rooms, objects, options.colliders, options.navigation)
    rows = SurfaceRows()
    rows.add(shell.surfaces)
    slot = {c.item.object_id: i for i, c in enumerate(solid.movable)}
    instances = _instances(shell, objects, rows, slot)
    models = {m.key: m for m in (shell.model, *(part.model for o in objects for part in o.parts))}
    first = _first_instances(objects)
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
        colliders=solid.static.colliders(solid.object_id),
        bodies=make_bodies(solid.movable, first),
        planes=build_planes(shell, rooms),
        rooms=rooms,
        navigation=build_navigation(house.id, rooms, solid.space, options.navigation, storeys),
        models=models,
        report=_report(house, shell, objects, solid),
        doors=_doors(objects, first, solid),
        stuck=np.array(solid.stuck, np.int32),
        lights=build_lights(objects, first, rooms, metadata, options.lights),
        gloss=gloss_table(rows.surfaces, objects, house.models, _first_rows(objects, first, instances)),
    )


def _first_rows(objects: Sequence[PlacedObject], first: Mapping[int, int], instances: Instances) -> list[int]:
    """First material row of each object."""
    return [int(instances.material[first[o.object_id]]) for o in objects]


def _first_instances(objects: Sequence[PlacedObject]) -> dict[int, int]:
    """Index of the first instance of each object; the architecture is instance 0."""
    counts = [1, *(len(o.parts) for o in objects)]
    return dict(zip((o.object_id for o in objects), np.cumsum(counts).tolist(), strict=False))


def _instances(shell: Shell, objects: Sequence[PlacedObject], rows: SurfaceRows, slot: Mapping[int, int]) -> Instances:
    """One instance per part of an object; the parts share its materials and meaning."""
    parts = [(row, o, part) for row, o in enumerate(objects) for part in o.parts]
    material = [rows.add(o.surfaces) for o in objects]
    return Instances(
        model=(shell.model.key, *(part.model.key for _, _, part in parts)),
        pose=np.stack([np.eye(3, 4), *(o.pose for _, o, _ in parts)]),
        object_id=np.array([-1, *(o.object_id for _, o, _ in parts)], np.int32),
        material=np.array([0, *(material[row] for row, _, _ in parts)], np.int32),
        semantic=np.array([0, *(len(shell.semantics) + row for row, _, _ in parts)], np.int32),
        body=np.array([-1, *(slot.get(o.object_id, -1) for _, o, _ in parts)], np.int32),
    )


def _doors(objects: Sequence[PlacedObject], first: Mapping[int, int], solid: Solid) -> Doors:
    leaves, rows = [], []
    for o in objects:
        for number, part in enumerate(o.parts[1:]):
            leaves.append(place_leaf(part, o.pose, first[o.object_id] + 1 + number, leaf_box(o, part.model)))
            rows.append(solid.leaf_row.get((o.object_id, number), -1))
    return make_doors(leaves, rows)


def _object_row(item: PlacedObject, slot: Mapping[int, int]) -> np.ndarray:
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


def _report(house: House, shell: Shell, objects: Sequence[PlacedObject], solid: Solid) -> dict[str, int]:
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
        "hinged_leaves": sum(len(o.parts) - 1 for o in objects),
        "problems": len(house.problems),
        **solid.report,
    }
