"""View of one house of a bank for task generators (host side)."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.core.transforms import quat_matrix, transform_bounds
from home_mjx.physics.hand_control import CARRY_CLEARANCE, CARRY_HEIGHT_BELOW_EYES
from home_mjx.physics.kinematic.footprints import Footprints
from home_mjx.schema.categories import COARSE, room_types_in
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.rules.cell_graph import CellGraph, EndCells
from home_mjx.tasks.rules.enums import Purpose, TargetKind
from home_mjx.tasks.sensors.front_reach import can_open_from, can_take_out_from, is_openable
from home_mjx.tasks.sensors.reachability import (
    can_pick_from,
    can_place_from,
    carry_gaps,
    carry_obstacles,
    plan_radius,
)
from home_mjx.tasks.sensors.visibility import is_visible_from, visible_ids

MAX_HAND_REACH = 0.93  # [m] maximum reach from a cell centre: below `AgentBody.reach`, as agents stop beside the centre
NUM_CELLS = 64  # number of cells tested per instance, nearest first
CELLS_PER_BATCH = 1024  # number of cells per batch of clearance queries
CARRY_HEIGHT_TOLERANCE = 0.02  # [m] tolerance of the heights by which obstacles of carried objects are chosen
MIN_OBSTACLES = 256  # minimum number of boxes of a clearance query, with padding
FRONT_STRIDE = 2  # stride of the cells before a front that are tested
CELL_STRIDE = 4  # stride of the cells within hand reach that are tested
MAX_EXTRA_DISTANCE = 0.3  # [m] paths to an object may end this much farther from it than the nearest cell
MAX_HEIGHT_ABOVE_TOP_FLOOR = 2.0  # [m] height above the highest floor; objects entirely above it are out of reach
EYE_DEPTH = 0.1  # [m] depth of the eyes below the top of an agent's body
NUM_HEADINGS = 9  # number of heading intervals tested per half turn
CARRY_GAP = 0.05  # [m] gap between the carrying agent and the carried object, added to `CARRY_CLEARANCE`
MAX_CARRY_OVERLAP = 0.04  # [m] allowed overlap of a carried object: its circle in plan is wider than its shape


@dataclass(frozen=True)
class HouseObject:
    """An object of a house."""

    object_id: int
    semantics: Int[np.ndarray, " columns"]  # of the semantic table; columns are those of `Semantic`
    box: Float[np.ndarray, "2 3"]  # [m], world bounds at the initial pose
    body: int  # movable body; -1 if static

    def semantic(self, column: Semantic) -> int:
        """Return a column of the object's semantic row; -1 if unknown."""
        return int(self.semantics[column])

    @property
    def room_types(self) -> tuple[int, ...]:
        """All labels of the object's room as indices into ROOM_TYPES, the first one first; () if unknown."""
        first = self.semantic(Semantic.ROOM_TYPE)
        return tuple(sorted(room_types_in(self.semantic(Semantic.ROOM_LABELS)), key=lambda kind: kind != first))

    @property
    def coarse(self) -> str:
        """Name of the coarse category; `unknown` if it has none."""
        return COARSE[self.semantic(Semantic.COARSE)] if self.semantic(Semantic.COARSE) >= 0 else "unknown"


class HouseView:
    """Geometry, semantics and reachability of one house, for task generators.

    Args:
        bank: The houses, with geometry, navigation and semantics on the host.
        house: Index of the house.
        boxes: World bounds of its instances [m].
        device_bank: The same houses on the device, for ray casting.
    """

    def __init__(self, bank: HouseBank, house: int, boxes: Float[np.ndarray, "i 2 3"], device_bank: HouseBank) -> None:
        self.bank, self.house, self._boxes, self._device = bank, house, boxes, device_bank
        self._beside: dict[int, EndCells] = {}
        self._at_hand: dict[tuple[int, float], EndCells] = {}
        self._taken: dict[int, EndCells] = {}
        self._opened: dict[int, EndCells] = {}
        self._stored: dict[tuple[int, int], EndCells] = {}

    @cached_property
    def graph(self) -> CellGraph:
        """Graph of the cells that agents can walk in."""
        return CellGraph(self.bank, self.house)

    @cached_property
    def objects(self) -> tuple[HouseObject, ...]:
        """Objects in rooms, and those on the lot, without trees, roofs and neighbouring buildings out of reach.

        Those on the lot overlap the fence rectangle, and begin below `MAX_HEIGHT_ABOVE_TOP_FLOOR` above the top floor.
        """
        low, high = np.asarray(self.bank.physics.fence_rectangle[self.house])
        floors = np.asarray(self.bank.navigation.floor[self.house])
        top = floors[np.isfinite(floors)].max() + MAX_HEIGHT_ABOVE_TOP_FLOOR
        return tuple(
            thing
            for thing in self.all_objects
            if thing.semantic(Semantic.ROOM) >= 0
            or ((thing.box[0] < [*high, top]).all() and (thing.box[1, :2] > low).all())
        )

    @cached_property
    def all_objects(self) -> tuple[HouseObject, ...]:
        """All rendered objects, in the order of their ids; a door's frame and leaves are one object."""
        geometry = self.bank.geometry
        ids, rows = geometry.instance_object[self.house], geometry.instance_semantic[self.house]
        semantics, found = np.asarray(self.bank.semantics), []
        for number in np.unique(ids[ids >= 0]).tolist():
            parts = np.flatnonzero(ids == number)
            box = np.stack([self._boxes[parts, 0].min(axis=0), self._boxes[parts, 1].max(axis=0)])
            body = int(geometry.instance_body[self.house, parts].max())
            found.append(HouseObject(number, semantics[rows[parts[0]]], box, body))
        return tuple(found)

    def instance_of(self, thing: HouseObject) -> int:
        """Return the index of an object's instance without its fronts; -1 if it has several, as doors, or none."""
        parts = np.flatnonzero(self.bank.geometry.instance_object[self.house] == thing.object_id)
        parts = np.setdiff1d(parts, self._fronts)
        return int(parts[0]) if len(parts) == 1 else -1

    @cached_property
    def _fronts(self) -> Int[np.ndarray, " f"]:
        """Instances of fronts of furniture."""
        rows = np.asarray(self.bank.fronts.leaf[self.house])
        return self._leaf_instance[rows[rows >= 0]]

    def fronts_of(self, thing: HouseObject) -> list[int]:
        """Return rows of the fronts of an object, along the bank's doors, that agents open: see `is_openable`."""
        rows = np.asarray(self.bank.fronts.leaf[self.house])[self._openable]
        owner = self.bank.geometry.instance_object[self.house][self._leaf_instance[rows]]
        return rows[owner == thing.object_id].tolist()

    @cached_property
    def _openable(self) -> Bool[np.ndarray, " fronts"]:
        """Mask of the bank's fronts that agents open."""
        return np.asarray(is_openable(self._device, self.house))

    @cached_property
    def _leaf_instance(self) -> Int[np.ndarray, " doors"]:
        """Instance of each door leaf of the house."""
        return np.asarray(self.bank.physics.door_instance[self.house])

    def compartments_of(self, thing: HouseObject) -> list[int]:
        """Return the compartments behind `fronts_of` an object, by their indices in the house."""
        return np.flatnonzero(np.isin(self.bank.compartments.door[self.house], self.fronts_of(thing))).tolist()

    def compartment_box(self, compartment: int) -> Float[np.ndarray, "2 3"]:
        """Return the world bounds of a compartment behind a shut front [m]."""
        boxes = self.bank.compartments
        pos, size, quat = (np.asarray(x[self.house, compartment]) for x in (boxes.pos, boxes.size, boxes.quat))
        half = np.abs(np.asarray(quat_matrix(quat, np))) @ size
        return np.stack([pos - half, pos + half])

    def open_cells(self, leaf: int) -> EndCells:
        """Return cells from which a hand opens a shut front (row of the bank's doors), clear of its motion."""
        if leaf not in self._opened:
            box = self._boxes[self._leaf_instance[leaf]]
            cells, away = self.graph.nearest_cells(box[0], box[1], FRONT_STRIDE * NUM_CELLS)
            cells, away = (x[away <= MAX_HAND_REACH][::FRONT_STRIDE] for x in (cells, away))
            eyes = jnp.asarray(self._padded_eyes(cells), jnp.float32)
            fits = can_open_from(self._device, self._number, eyes, jnp.int32(leaf), jnp.float32(MAX_HAND_REACH))
            good = np.asarray(fits)[: len(cells)]
            self._opened[leaf] = cells[good], away[good]
        return self._opened[leaf]

    def stored_cells(self, instance: int, compartment: int) -> EndCells:
        """Return those of `open_cells` from which a hand takes an instance out of a compartment, and carries it away.

        Empty if it is visible there while the front is shut.
        """
        key = instance, compartment
        if key not in self._stored:
            ends = self.open_cells(int(self.bank.compartments.door[self.house, compartment]))
            body = int(self.bank.geometry.instance_body[self.house, instance])
            eyes = jnp.asarray(self._padded_eyes(ends[0]), jnp.float32)
            what = jnp.int32(body), jnp.int32(compartment), jnp.float32(MAX_HAND_REACH)
            good = np.asarray(can_take_out_from(self._device, self._number, eyes, *what))[: len(ends[0])]
            middle = self.compartment_box(compartment).mean(axis=0)
            self._stored[key] = self._carry_cells(instance, middle, (ends[0][good], ends[1][good]))
        return self._stored[key]

    @cached_property
    def rooms_by_type(self) -> dict[int, tuple[int, ...]]:
        """Room indices with each label, by index into ROOM_TYPES; a room with several labels is in several entries."""
        found: dict[int, tuple[int, ...]] = {}
        for room, labels in enumerate(np.asarray(self.bank.navigation.room_labels[self.house]).tolist()):
            for kind in room_types_in(labels):
                found[kind] = (*found.get(kind, ()), room)
        return dict(sorted(found.items()))

    def end_cells(
        self,
        kind: int,
        instances: Bool[np.ndarray, " i"],
        rooms: Bool[np.ndarray, " r"],
        place: np.ndarray,
        use: Purpose = Purpose.LOOK,
        radius: float = 0.0,
    ) -> EndCells:
        """Return the end cells of paths to a descriptor's targets, and the distance from each to its target [m].

        A descriptor of the given `kind` has target instances, rooms or a `place` [m]. To PUT an object of a plan
        `radius` [m] on an instance, to TAKE or TOGGLE one, other cells are needed than to LOOK at it. A cell is
        repeated if it serves several instances. Both are empty without targets, or without such cells.
        """
        if kind == TargetKind.PLACE:
            return self.graph.nearest_cell(place)
        if kind == TargetKind.ROOM:
            return self.graph.cells_in_rooms(rooms)
        part = {
            Purpose.LOOK: self.view_cells,
            Purpose.TAKE: self.take_cells,
            Purpose.TOGGLE: self.touch_cells,
            Purpose.PUT: lambda i: self.put_cells(i, radius),
        }[use]
        which = np.flatnonzero(instances).tolist()
        parts = self._nearest_view_cells(which) if use == Purpose.LOOK else [part(i) for i in which]
        if not parts:
            return np.zeros(0, int), np.zeros(0)
        cells, away = (np.concatenate(part) for part in zip(*parts, strict=True))
        return cells, away

    def _nearest_view_cells(self, which: list[int]) -> list[EndCells]:
        """Return, for each of some instances, those of its `view_cells` to which no other of these instances is nearer.

        Near is in a straight line from the middle of an agent there to the bounds; ties count for all. Conditions test
        the nearest target, so this one must be visible from a path's end.
        """
        parts, boxes = [], self._boxes[which]
        for at, instance in enumerate(which):
            cells, away = self.view_cells(instance)
            middle = self.graph.place[cells, None] + [0, 0, self.bank.spec.agent_height / 2]
            gap = np.linalg.norm(np.maximum(boxes[:, 0] - middle, 0) + np.maximum(middle - boxes[:, 1], 0), axis=-1)
            nearest = gap[:, at] <= gap.min(axis=1)
            parts.append((cells[nearest], away[nearest]))
        return parts

    def plan_radius(self, instance: int) -> float:
        """Return the plan radius [m] of a movable instance about its middle, rounded up to centimetres; 0 if static."""
        body, physics = int(self.bank.geometry.instance_body[self.house, instance]), self.bank.physics
        if body < 0:
            return 0.0
        size, quat = (jnp.asarray(x[self.house, body]) for x in (physics.body_size, physics.body_quat))
        return round(float(plan_radius(size, quat)) + 0.005, 2)

    def take_cells(self, instance: int) -> EndCells:
        """Return cells from which a hand can take an instance and carry it away.

        Only every `CELL_STRIDE`-th cell within `MAX_HAND_REACH` is tested, at most `NUM_CELLS`: if the result is empty,
        others may exist. In these cells an agent that holds the instance has room for a half turn. The largest
        connected set of cells where it fits is within `MAX_TURN_DISTANCE`.
        """
        if instance not in self._taken:
            middle = self._boxes[instance].mean(axis=0)
            self._taken[instance] = self._carry_cells(instance, middle, self.touch_cells(instance))
        return self._taken[instance]

    def _carry_cells(self, instance: int, middle: Float[np.ndarray, "3"], ends: EndCells) -> EndCells:
        """Return those of some end cells from which an instance that is taken at `middle` [m] can be carried away."""
        (cells, away), obstacles = ends, self._carry_obstacles(instance)
        wide = self._carry_gaps(instance, obstacles, self.graph.place) > self.plan_radius(instance)
        out = self.graph.has_turning_room(cells, wide)
        cells, away = cells[out], away[out]
        turns = self._has_turning_room(instance, middle, obstacles, cells)
        return cells[turns], away[turns]

    def touch_cells(self, instance: int) -> EndCells:
        """Return cells from which a hand reaches an instance; a sample as in `take_cells`, so others may exist."""

        def there(eyes: Array) -> Array:
            """Return at which of the eyes [m] a hand reaches the instance."""
            box = jnp.asarray(self._boxes[instance], jnp.float32)
            return can_pick_from(
                self._device, self._number, eyes, jnp.int32(instance), box, jnp.float32(MAX_HAND_REACH)
            )

        return self._cells_at_hand((instance, -1.0), there)

    def _has_turning_room(
        self, instance: int, middle: Float[np.ndarray, "3"], obstacles: Footprints, cells: Int[np.ndarray, " n"]
    ) -> Bool[np.ndarray, " n"]:
        """Return in which cells an agent that holds an instance can make a half turn, to the left or to the right.

        The turn begins towards `middle` [m], from where it is taken.
        """
        place, radius = self.graph.place[cells], self.plan_radius(instance)
        begin = np.arctan2(*(middle - place)[:, 1::-1].T)
        yaw = begin[:, None] + np.linspace(-np.pi, np.pi, 2 * NUM_HEADINGS + 1)
        ahead = self.bank.spec.agent_radius + CARRY_CLEARANCE + radius + CARRY_GAP
        way = np.stack([np.cos(yaw), np.sin(yaw), np.zeros_like(yaw)], axis=-1)
        gap = self._carry_gaps(instance, obstacles, (place[:, None] + ahead * way).reshape(-1, 3))
        free = gap.reshape(yaw.shape) > radius - MAX_CARRY_OVERLAP
        return np.logical_or(free[:, : NUM_HEADINGS + 1].all(axis=1), free[:, NUM_HEADINGS:].all(axis=1))

    def _carry_gaps(
        self, instance: int, obstacles: Footprints, places: Float[np.ndarray, "n 3"]
    ) -> Float[np.ndarray, " n"]:
        """Return the plan gap from floor points to the nearest obstacle at the height of a carried instance [m]."""
        half = np.float32(np.diff(self._boxes[instance, :, 2]).item() / 2)
        eyes = self._eyes(places)
        boxes = _select_obstacles(obstacles, eyes, float(half))
        blocks = np.full((-len(eyes) % CELLS_PER_BATCH + len(eyes), 3), np.inf, np.float32)
        blocks[: len(eyes)] = eyes
        parts = [carry_gaps(boxes, jnp.asarray(part), half) for part in blocks.reshape(-1, CELLS_PER_BATCH, 3)]
        return np.concatenate([np.zeros(0), *parts])[: len(eyes)]

    def _carry_obstacles(self, instance: int) -> Footprints:
        """Return the boxes of the house that a carried instance could touch, on the host; see `carry_obstacles`."""
        carried = jnp.int32(self.bank.geometry.instance_object[self.house, instance])
        return jax.tree.map(np.asarray, carry_obstacles(self._device, self._number, carried))

    def put_cells(self, instance: int, radius: float) -> EndCells:
        """Return cells from which a hand can put an object of some plan radius [m] on an instance; may be empty.

        As in `take_cells`, only a sample of cells is tested, so others may exist.
        """

        def there(eyes: Array) -> Array:
            """Return at which of the eyes [m] a hand can place the object."""
            box, size = jnp.asarray(self._boxes[instance], jnp.float32), jnp.float32(radius)
            return can_place_from(
                self._device, self._number, eyes, jnp.int32(instance), box, size, jnp.float32(MAX_HAND_REACH)
            )

        return self._cells_at_hand((instance, radius), there)

    @property
    def _number(self) -> Int[Array, ""]:
        """Index of the house as a device scalar."""
        return jnp.int32(self.house)

    def _cells_at_hand(self, key: tuple[int, float], there: Callable[[Array], Array]) -> EndCells:
        """Return end cells within `MAX_HAND_REACH` of an instance: those of every `CELL_STRIDE`-th that pass `there`.

        At most `NUM_CELLS` cells are tested. `there` maps eye positions (n, 3) to a mask. `key`, under which they are
        cached, begins with the instance.
        """
        if key not in self._at_hand:
            box = self._boxes[key[0]]
            cells, away = self.graph.nearest_cells(box[0], box[1], CELL_STRIDE * NUM_CELLS)
            cells, away = (x[away <= MAX_HAND_REACH][::CELL_STRIDE] for x in (cells, away))
            good = np.asarray(there(jnp.asarray(self._padded_eyes(cells), jnp.float32)))[: len(cells)]
            self._at_hand[key] = cells[good], away[good]
        return self._at_hand[key]

    def _padded_eyes(self, cells: Int[np.ndarray, " c"]) -> Float[np.ndarray, "n 3"]:
        """Return eye positions above cells [m], padded with inf to `NUM_CELLS` rows."""
        eyes = np.full((NUM_CELLS, 3), np.inf)
        eyes[: len(cells)] = self._eyes(self.graph.place[cells])
        return eyes

    def view_cells(self, instance: int) -> EndCells:
        """Return the cells with a robust view of an instance: the nearest, and up to `MAX_EXTRA_DISTANCE` farther.

        Robust: visible from the cell's centre and from all `visibility.EYE_OFFSETS` around it. Empty if none of
        the `NUM_CELLS` nearest cells qualifies, as for an object behind a wall or in a chest.
        """
        if instance not in self._beside:
            box = self._boxes[instance]
            cells, away = self.graph.nearest_cells(box[0], box[1], NUM_CELLS)
            seen = is_visible_from(self._device, self.house, self._padded_eyes(cells), box)[: len(cells)]
            near = seen & (away <= np.min(away, where=seen, initial=np.inf) + MAX_EXTRA_DISTANCE)
            self._beside[instance] = cells[near], away[near]
        return self._beside[instance]

    def is_visible(self, thing: HouseObject) -> bool:
        """Return whether any part of an object has `view_cells`: it is visible from beside it."""
        parts = np.flatnonzero(self.bank.geometry.instance_object[self.house] == thing.object_id)
        return any(len(self.view_cells(part)[0]) for part in parts.tolist())

    def image_fractions(self, places: Float[np.ndarray, "n 3"], yaw: Float[np.ndarray, " n"]) -> list[dict[int, float]]:
        """Render level views at floor points [m] and headings [rad]; return image fractions by visible object id.

        There is a dictionary per view, without the architecture and misses (-1).
        """
        images = visible_ids(self._device, self.house, self._eyes(places), yaw)
        found = [np.unique(image[image >= 0], return_counts=True) for image in images]
        return [dict(zip(ids.tolist(), (counts / images[0].size).tolist(), strict=True)) for ids, counts in found]

    def _eyes(self, places: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
        """Return eye positions [m] of agents that stand at floor points."""
        return places + np.array([0, 0, self.bank.spec.agent_height - EYE_DEPTH])


def _select_obstacles(boxes: Footprints, eyes: Float[np.ndarray, "n 3"], half: float) -> Footprints:
    """Return the boxes that an object could touch which is carried below any of `eyes` [m]; see `carry_gaps`.

    `half` is half of the object's height [m]. Their number is padded to a power of two, as every size is compiled
    separately.
    """
    middle = np.unique(np.round(eyes[:, 2] - CARRY_HEIGHT_BELOW_EYES, 2))[:, None]
    reach = half + CARRY_HEIGHT_TOLERANCE
    met = np.flatnonzero(((boxes.top > middle - reach) & (boxes.bottom < middle + reach)).any(axis=0))
    rows = np.zeros(max(1 << max(len(met) - 1, 0).bit_length(), MIN_OBSTACLES), np.intp)
    rows[: len(met)] = met
    unused = np.arange(len(rows)) >= len(met)
    boxes = jax.tree.map(lambda x: x[rows], boxes)
    return boxes.replace(bottom=np.where(unused, np.float32(np.inf), boxes.bottom))


def house_views(bank: HouseBank) -> tuple[HouseView, ...]:
    """Return a `HouseView` of each house, in the order of the bank.

    Its geometry, navigation and semantics are on the host; other arrays stay where they are.
    """
    geometry = bank.geometry
    boxes = np.asarray(_instance_boxes(geometry.instance_pose, geometry.instance_model, geometry.model_box))
    host = bank.replace(geometry=bank.geometry.replace(gpu=None))
    host = host.replace(
        geometry=jax.tree.map(np.asarray, host.geometry),
        navigation=jax.tree.map(np.asarray, host.navigation),
        semantics=np.asarray(bank.semantics),
    )
    return tuple(HouseView(host, house, boxes[house], bank) for house in range(bank.num_houses))


@jax.jit
def _instance_boxes(pose: Array, model: Array, model_box: Array) -> Float[Array, "h i 2 3"]:
    """Compute the world bounds of the instances of all houses [m]; those of padding mean nothing."""
    return jax.vmap(jax.vmap(transform_bounds))(pose, model_box[jnp.maximum(model, 0)])
