"""Last stages of the compiler: surfaces, and the assembly of all results into one `CompiledHouse`."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from home_mjx.geometry.diffraction_edges import exposed_edge_bits
from home_mjx.geometry.meshes import build_instance_tree, instance_box
from home_mjx.scene_compile.architecture.reflection_planes import build_reflection_planes
from home_mjx.scene_compile.architecture.rooms import HouseFrame, ground_floor_height
from home_mjx.scene_compile.architecture.shell import BuildingShell
from home_mjx.scene_compile.collision.barriers import lot_bounds
from home_mjx.scene_compile.lighting.gloss import gloss_table
from home_mjx.scene_compile.materials.surface import SurfaceMaterial, SurfaceRows, material_table
from home_mjx.scene_compile.navigation.reach import find_unreachable_storeys
from home_mjx.scene_compile.objects.leaves import MIN_DRAWER_OPENING, MIN_OPEN_ANGLE
from home_mjx.scene_compile.objects.placed_objects import PlacedObject
from home_mjx.scene_compile.pipeline.levels import LevelGeometry
from home_mjx.schema.compiled import Bodies, CompiledHouse, HouseNavigation, Instances, MaterialTable, Model, Planes
from home_mjx.schema.lighting import Gloss, LightTable

AGENT_SURFACES = (  # body and visor of the agent's model, in the order of its material slots
    SurfaceMaterial((0.15, 0.35, 0.75), kind="textile"),
    SurfaceMaterial((0.95, 0.75, 0.1), kind="plastic"),
)


@dataclass(frozen=True)
class HouseSurfaces:
    """Optical and acoustic properties of a house's surfaces.

    Attributes:
        materials: Material rows; those of the shell are first.
        first_row: First row of each object.
        gloss: Gloss of each row.
        planes: Rectangles that reflect sound.
    """

    materials: MaterialTable
    first_row: Sequence[int]
    gloss: Gloss
    planes: Planes


def build_surfaces(frame: HouseFrame, shell: BuildingShell, objects: Sequence[PlacedObject]) -> HouseSurfaces:
    """Build the material rows of the shell and of all objects, their gloss, and the planes that reflect sound.

    Each object has one row per material slot; objects with equal materials in all slots share their rows.
    """
    rows = SurfaceRows()
    rows.add(shell.surfaces)
    first = [rows.add(o.surfaces) for o in objects]
    return HouseSurfaces(
        materials=material_table(rows.surfaces),
        first_row=first,
        gloss=gloss_table(rows.surfaces, objects, frame.house.models, first),
        planes=build_reflection_planes(shell, frame.rooms),
    )


def assemble(
    frame: HouseFrame,
    shell: BuildingShell,
    objects: Sequence[PlacedObject],
    levels: LevelGeometry,
    navigation: HouseNavigation,
    surfaces: HouseSurfaces,
    lights: LightTable,
    semantics: Int[np.ndarray, "q columns"],
) -> CompiledHouse:
    """Assemble the compiled house from the results of all stages.

    `semantics` has the rows of the shell's parts, then of the objects.
    """
    instances = _instances(shell, objects, surfaces.first_row, levels.bodies)
    models = {m.key: m for m in (shell.model, *(part for o in objects for part in o.parts))}
    return CompiledHouse(
        id=frame.house.id,
        offset=frame.offset,
        box=_bounds(instances, models),
        instances=instances,
        top_bvh=build_instance_tree(instances, models, levels.doors.instance),
        materials=surfaces.materials,
        semantics=semantics,
        colliders=levels.colliders,
        exposed_edges=exposed_edge_bits(levels.colliders, frame.rooms),
        bodies=levels.bodies,
        planes=surfaces.planes,
        rooms=frame.rooms,
        navigation=navigation,
        models=models,
        ground_floor=ground_floor_height(frame.rooms),
        lot=lot_bounds(frame.rooms),
        agent_materials=material_table(AGENT_SURFACES),
        report=_report(frame, shell, objects, levels, navigation),
        doors=levels.doors,
        ramps=levels.ramps,
        lights=lights,
        gloss=surfaces.gloss,
        blocked_objects=levels.stuck_objects,
        compartments=levels.compartments,
    )


def _instances(
    shell: BuildingShell, objects: Sequence[PlacedObject], first_row: Sequence[int], bodies: Bodies
) -> Instances:
    """Return the architecture's instance, then one per part of each object; these share material and semantic rows."""
    body = {instance: row for row, instance in enumerate(bodies.instance.tolist())}
    parts = [(i, o, part) for i, o in enumerate(objects) for part in o.parts]
    poses = [pose for o in objects for pose in o.poses]
    return Instances(
        model=(shell.model.key, *(part.key for _, _, part in parts)),
        pose=np.stack([np.eye(3, 4), *poses]),
        object_id=np.array([-1, *(o.object_id for _, o, _ in parts)], np.int32),
        material=np.array([0, *(first_row[i] for i, _, _ in parts)], np.int32),
        semantic=np.array([0, *(len(shell.semantics) + i for i, _, _ in parts)], np.int32),
        body=np.array([-1, *(body.get(o.instance, -1) for _, o, _ in parts)], np.int32),
    )


def _bounds(instances: Instances, models: Mapping[str, Model]) -> Float[np.ndarray, "2 3"]:
    """Return the bounding box of all instances in the world [m]."""
    boxes = np.array([instance_box(p, models[k].box) for p, k in zip(instances.pose, instances.model, strict=True)])
    return np.stack([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])


def _report(
    frame: HouseFrame,
    shell: BuildingShell,
    objects: Sequence[PlacedObject],
    levels: LevelGeometry,
    navigation: HouseNavigation,
) -> dict[str, int]:
    """Return counts by name of the input and of the compiled house, such as `rooms` and `colliders`."""
    house = frame.house
    ranges = (levels.doors.high - levels.doors.low)[levels.doors.is_front]
    slides = levels.doors.is_sliding[levels.doors.is_front]
    lost = find_unreachable_storeys(levels.spaces, navigation.region, levels.stairs, navigation.cell)
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
        "colliders": len(levels.colliders.pos),
        "bodies": len(levels.bodies.mass),
        "hinged_leaves": sum(len(o.leaves) for o in objects),
        "fronts": len(ranges),
        "drawers": int(slides.sum()),
        "blocked_fronts": int((ranges < np.where(slides, MIN_DRAWER_OPENING, MIN_OPEN_ANGLE)).sum()),
        "compartments": sum(len(o.pockets) for o in objects),
        "shut_leaves": sum(len(o.shut_leaves) for o in objects),
        "problems": len(house.problems),
        "fallbacks": len(house.fallbacks),
        **levels.report,
        "unreachable_storeys": len(lost),
    }
