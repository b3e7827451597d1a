"""The padded tables of a `HouseBank`: materials, physics, mirror planes, navigation. See `pack`."""

from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Float, Int

from home_mjx.bank.packing.capacity import Capacity
from home_mjx.bank.packing.padding import pad, repeat
from home_mjx.core.color import decode_srgb
from home_mjx.errors import ConfigError
from home_mjx.scene_compile.architecture.rooms import ground_floor
from home_mjx.scene_compile.geometry.boxes import box_inertia
from home_mjx.schema.compiled import CompiledHouse, MaterialTable, Navigation
from home_mjx.schema.lighting import Gloss
from home_mjx.schema.material_kinds import MATERIAL_KINDS

Arrays = dict[str, np.ndarray]

PARKED = np.array([0.0, 0.0, -100.0])  # [m], where padded boxes lie: far below any house
UPRIGHT = np.array([1.0, 0.0, 0.0, 0.0])
SMALL = np.full(3, 0.1)  # [m], half extents of padded boxes
KIND_INDEX = {"": -1} | {name: i for i, name in enumerate(MATERIAL_KINDS)}


def shift(rows: Sequence[np.ndarray], starts: Sequence[int]) -> list[np.ndarray]:
    """Row numbers of each house made absolute."""
    return [row + start for row, start in zip(rows, starts, strict=True)]


def material_rows(table: MaterialTable, layer: Mapping[str, int]) -> Arrays:
    """Rows of the concatenated material tables.

    Args:
        table: Materials of one house, or of the agent.
        layer: Texture layer by path.
    """
    return {
        "geometry.material_mask": table.mask,
        "materials.albedo": _linear(table.albedo),
        "materials.texture": np.array([layer[path] for path in table.texture], np.int32),
        "materials.kind": np.array([KIND_INDEX[name] for name in table.kind], np.int32),
        "materials.absorption": table.absorption,
        "materials.scattering": table.scattering,
        "materials.transmission": table.transmission,
    }


def _linear(albedo: Float[np.ndarray, "r 4"]) -> Float[np.ndarray, "r 4"]:
    """Linear light from sRGB; opacity stays."""
    return np.concatenate([decode_srgb(albedo[:, :3]), albedo[:, 3:]], axis=1)


def gloss_rows(gloss: Gloss, count: int) -> Arrays:
    """Rows of the concatenated gloss tables, as many as there are materials."""
    missing = count - len(gloss.mirror)
    return {
        "finish.specular": np.pad(gloss.specular, ((0, missing), (0, 0))),
        "finish.shininess": np.pad(gloss.shininess, (0, missing), constant_values=1),
        "finish.mirror": np.pad(gloss.mirror, (0, missing)),
    }


def pack_lights(houses: Sequence[CompiledHouse], capacity: Capacity) -> Arrays:
    """Lights, and the ambient light of the rooms."""
    tables, size = [h.lights for h in houses], capacity.lights
    ambient = [t.ambient for t in tables]
    down = np.array([0.0, 0.0, -1.0])
    return {
        "pos": pad([t.pos for t in tables], size, np.float32, PARKED),
        "axis_u": pad([t.axis_u for t in tables], size, np.float32, 0),
        "axis_v": pad([t.axis_v for t in tables], size, np.float32, 0),
        "direction": pad([t.direction for t in tables], size, np.float32, down),
        "intensity": pad([t.intensity for t in tables], size, np.float32, 0),
        "exponent": pad([t.exponent for t in tables], size, np.float32, 0),
        "cutoff": pad([t.cutoff for t in tables], size, np.float32, -2),
        "area": pad([t.area for t in tables], size, np.float32, 0),
        "daylight": pad([t.daylight for t in tables], size, np.bool_, False),
        "instance": pad([t.instance for t in tables], size, np.int32, -1),
        "room": pad([t.room for t in tables], size, np.int32, -1),
        "ambient": pad(ambient, capacity.rooms + 1, np.float32, 0),
    }


def pack_physics(houses: Sequence[CompiledHouse], capacity: Capacity) -> Arrays:
    """Static boxes and movable bodies."""
    bodies, colliders = [h.bodies for h in houses], [h.colliders for h in houses]
    num_bodies, num_colliders = capacity.bodies, capacity.colliders
    arrays = {
        "floor": np.array([ground_floor(h.rooms) for h in houses], np.float32),
        "collider_pos": pad([c.pos for c in colliders], num_colliders, np.float32, PARKED),
        "collider_quat": pad([c.quat for c in colliders], num_colliders, np.float32, UPRIGHT),
        "collider_size": pad([c.size for c in colliders], num_colliders, np.float32, SMALL),
        "body_valid": pad([np.ones(len(b.mass)) for b in bodies], num_bodies, np.bool_, False),
        "body_instance": pad([b.instance for b in bodies], num_bodies, np.int32, -1),
        "body_pos": pad([b.pos for b in bodies], num_bodies, np.float32, PARKED),
        "body_quat": pad([b.quat for b in bodies], num_bodies, np.float32, UPRIGHT),
        "body_size": pad([b.size for b in bodies], num_bodies, np.float32, SMALL),
        "body_mass": pad([b.mass for b in bodies], num_bodies, np.float32, 1),
        "body_from_model": pad([b.from_model for b in bodies], num_bodies, np.float32, np.eye(3, 4)),
    }
    return arrays | {"body_inertia": box_inertia(arrays["body_mass"], arrays["body_size"])}


def pack_planes(houses: Sequence[CompiledHouse], material_start: Sequence[int], capacity: Capacity) -> Arrays:
    """Mirror planes."""
    planes, size = [h.planes for h in houses], capacity.planes
    return {
        "plane_valid": pad([np.ones(len(p.material)) for p in planes], size, np.bool_, False),
        "plane_center": pad([p.center for p in planes], size, np.float32, PARKED),
        "plane_normal": pad([p.normal for p in planes], size, np.float32, np.array([0, 0, 1])),
        "plane_u": pad([p.axis_u for p in planes], size, np.float32, np.array([1, 0, 0])),
        "plane_v": pad([p.axis_v for p in planes], size, np.float32, np.array([0, 1, 0])),
        "plane_material": pad(shift([p.material for p in planes], material_start), size, np.int32, 0),
    }


def navigation_rows(house: CompiledHouse, capacity: Capacity) -> Arrays:
    """Rows of the concatenated tables of cells in which an agent can stand."""
    n = house.navigation
    return {"navigation.place": n.place, "navigation.field": repeat(n.field.T, capacity.goals).T}


def pack_navigation(houses: Sequence[CompiledHouse], first_cell: Sequence[int], capacity: Capacity) -> Arrays:
    """Grids, rooms, starts and goals."""
    maps, types = [h.navigation for h in houses], [h.rooms.type for h in houses]
    if len({round(m.cell, 9) for m in maps}) > 1:
        raise ConfigError("the houses of a bank must have one navigation cell size", hint="Compile them alike.")
    portals, size = [m.portals for m in maps], capacity.portals
    return {
        "origin": np.array([m.origin for m in maps], np.float32),
        "floor": pad([m.floor for m in maps], capacity.levels, np.float32, np.inf),
        "first_cell": np.array(first_cell, np.int32),
        "num_cells": np.array([len(m.field) for m in maps], np.int32),
        "cell": pad_grids([_cell_numbers(m, at) for m, at in zip(maps, first_cell, strict=True)], capacity, np.int32),
        "region": pad_grids([m.region for m in maps], capacity, np.int16),
        "room": pad_grids([m.room for m in maps], capacity, np.int16),
        "room_type": pad(types, capacity.rooms, np.int32, -1),
        "start": np.stack([repeat(m.start, capacity.starts) for m in maps]).astype(np.float32),
        "goal": np.stack([repeat(m.goal, capacity.goals) for m in maps]).astype(np.float32),
        "portal_room": pad([p.room for p in portals], size, np.int32, -1),
        "portal_pos": pad([p.pos for p in portals], size, np.float32, 0),
        "portal_width": pad([p.width for p in portals], size, np.float32, 0),
        "portal_kind": pad([p.kind for p in portals], size, np.int32, -1),
        "room_hops": np.stack([_square(m.room_hops, capacity.rooms) for m in maps]).astype(np.int16),
    }


def _cell_numbers(n: Navigation, first: int) -> Int[np.ndarray, "l ny nx"]:
    return np.where(n.free, first + np.cumsum(n.free).reshape(n.free.shape) - 1, -1)


def pad_grids(grids: Sequence[Int[np.ndarray, "_ _ _"]], capacity: Capacity, dtype: type) -> np.ndarray:
    """Grids of all levels, stacked, with -1 around."""
    out = np.full((len(grids), capacity.levels, capacity.grid_rows, capacity.grid_columns), -1, dtype)
    for target, (layers, rows, columns), grid in zip(out, [g.shape for g in grids], grids, strict=True):
        target[:layers, :rows, :columns] = grid
    return out


def _square(table: Int[np.ndarray, "r r"], size: int) -> Int[np.ndarray, "s s"]:
    return np.pad(table, (0, size - len(table)), constant_values=-1)
