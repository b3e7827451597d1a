"""View of one house of a bank for task generators (host side)."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.core.transforms import bounds
from home_mjx.physics.hands import CARRY
from home_mjx.schema.categories import COARSE
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.rules.fields import CellGraph, Ends
from home_mjx.tasks.rules.words import Kind, Use
from home_mjx.tasks.sensors.reaching import gaps_carrying, plan_radius, put_from, taken_from
from home_mjx.tasks.sensors.sight import ids_in_view, seen_from

HAND = 0.93  # [m] maximum reach from a cell centre: below `Body.reach`, as agents stop beside the centre
CELLS = 64  # number of cells tested per instance, nearest first
BLOCK = 1024  # number of cells per batch of clearance queries
EVERY = 4  # stride of the cells within hand reach that are tested
REACH = 0.3  # [m] paths to an object may end this much farther from it than the nearest cell
STOREY = 2.0  # [m] height above the highest floor; objects entirely above it are out of reach
BELOW_TOP = 0.1  # [m] depth of the eyes below the top of an agent's body
HEADINGS = 9  # number of heading intervals tested per half turn
APART = 0.05  # [m] gap between the carrying agent and the carried object, added to `CARRY`
SLACK = 0.04  # [m] allowed overlap of a carried object: its circle in plan is wider than its shape


@dataclass(frozen=True)
class Thing:
    """An object of a house."""

    object_id: int
    row: Int[np.ndarray, " columns"]  # of the semantic table; columns are those of `Semantic`
    box: Float[np.ndarray, "2 3"]  # [m], world bounds at the initial pose
    body: int  # movable body; -1 if static

    def word(self, column: Semantic) -> int:
        """Return a column of the object's semantic row; -1 if unknown."""
        return int(self.row[column])

    @property
    def coarse(self) -> str:
        """Name of the coarse category."""
        return COARSE[self.word(Semantic.COARSE)] if self.word(Semantic.COARSE) >= 0 else "unknown"


class HouseView:
    """Geometry, semantics and reachability of one house, for task generators.

    Args:
        bank: The houses, with arrays on the host.
        house: Index of the house.
        boxes: World bounds of its instances [m].
        device: The same houses on the device, for ray casting.
    """

    def __init__(self, bank: HouseBank, house: int, boxes: Float[np.ndarray, "i 2 3"], device: HouseBank) -> None:
        self.bank, self.house, self._boxes, self._device = bank, house, boxes, device
        self._beside: dict[int, Ends] = {}
        self._at_hand: dict[tuple[int, float], Ends] = {}
        self._taken: dict[int, Ends] = {}

    @cached_property
    def graph(self) -> CellGraph:
        """Graph of the cells that agents can walk in."""
        return CellGraph(self.bank, self.house)

    @cached_property
    def things(self) -> tuple[Thing, ...]:
        """Objects in the house and on its lot, without trees, roofs and neighbouring buildings out of reach."""
        low, high = np.asarray(self.bank.physics.lot[self.house])
        floors = np.asarray(self.bank.navigation.floor[self.house])
        top = floors[np.isfinite(floors)].max() + STOREY
        return tuple(
            thing
            for thing in self.everything
            if thing.word(Semantic.ROOM) >= 0
            or ((thing.box[0] < [*high, top]).all() and (thing.box[1, :2] > low).all())
        )

    @cached_property
    def everything(self) -> tuple[Thing, ...]:
        """All rendered objects; a door's frame and leaves are one object."""
        geometry = self.bank.geometry
        ids, rows = geometry.instance_object[self.house], geometry.instance_semantic[self.house]
        semantics, found = np.asarray(self.bank.semantics), []
        for number in np.unique(ids[ids >= 0]).tolist():
            parts = np.flatnonzero(ids == number)
            box = np.stack([self._boxes[parts, 0].min(axis=0), self._boxes[parts, 1].max(axis=0)])
            body = int(geometry.instance_body[self.house, parts].max())
            found.append(Thing(number, semantics[rows[parts[0]]], box, body))
        return tuple(found)

    def instance_of(self, thing: Thing) -> int:
        """Return the instance of an object; -1 if it has several parts."""
        parts = np.flatnonzero(self.bank.geometry.instance_object[self.house] == thing.object_id)
        return int(parts[0]) if len(parts) == 1 else -1

    @cached_property
    def room_types(self) -> Int[np.ndarray, " r"]:
        """Type of each room as an index into ROOM_TYPES; -1 if unknown, and for padding."""
        return np.asarray(self.bank.navigation.room_type[self.house])

    def ends(
        self,
        kind: int,
        instances: Bool[np.ndarray, " i"],
        rooms: Bool[np.ndarray, " r"],
        place: np.ndarray,
        use: Use = Use.LOOK,
        radius: float = 0.0,
    ) -> Ends:
        """Return the end cells of paths to a descriptor's targets, and the distance from each to its target [m].

        Args:
            kind: Kind of the descriptor.
            instances: Its target instances.
            rooms: Its target rooms.
            place: Its target point [m].
            use: Purpose of going there.
            radius: Plan radius of an object to be put there [m].
        """
        if kind == Kind.PLACE:
            return self.graph.at(place)
        if kind == Kind.ROOM:
            return self.graph.inside(rooms)
        part = {Use.LOOK: self.beside, Use.TAKE: self.taken, Use.PUT: lambda i: self.put(i, radius)}[use]
        which = np.flatnonzero(instances).tolist()
        parts = self._nearest_of(which) if use == Use.LOOK else [part(i) for i in which]
        if not parts:
            return np.zeros(0, int), np.zeros(0)
        cells, away = (np.concatenate(part) for part in zip(*parts, strict=True))
        return cells, away

    def _nearest_of(self, which: list[int]) -> list[Ends]:
        """Return, for each of some instances, the cells beside it to which none of the others is nearer.

        Conditions test the nearest target, so this one must be visible from a path's end.
        """
        parts, boxes = [], self._boxes[which]
        for at, instance in enumerate(which):
            cells, away = self.beside(instance)
            middle = self.graph.place[cells, None] + [0, 0, self.bank.spec.agent_height / 2]
            gap = np.linalg.norm(np.maximum(boxes[:, 0] - middle, 0) + np.maximum(middle - boxes[:, 1], 0), axis=-1)
            nearest = gap[:, at] <= gap.min(axis=1)
            parts.append((cells[nearest], away[nearest]))
        return parts

    def radius(self, instance: int) -> float:
        """Return the plan radius of a movable object around its middle [m]; 0 if it is static."""
        body, physics = int(self.bank.geometry.instance_body[self.house, instance]), self.bank.physics
        if body < 0:
            return 0.0
        size, quat = (jnp.asarray(x[self.house, body]) for x in (physics.body_size, physics.body_quat))
        return round(float(plan_radius(size, quat)) + 0.005, 2)

    def taken(self, instance: int) -> Ends:
        """Return the cells from which a hand can take an instance and carry it away; empty if there are none."""

        def there(eyes: Array) -> Array:
            box = jnp.asarray(self._boxes[instance], jnp.float32)
            return taken_from(self._device, self._number, eyes, jnp.int32(instance), box, jnp.float32(HAND))

        if instance not in self._taken:
            cells, away = self._at_hand_of((instance, -1.0), there)
            wide = self._gaps_carrying(instance, self.graph.place) > self.radius(instance)
            out = self.graph.leads_out(cells, wide)
            cells, away = cells[out], away[out]
            turns = self._can_turn(instance, cells)
            self._taken[instance] = cells[turns], away[turns]
        return self._taken[instance]

    def _can_turn(self, instance: int, cells: Int[np.ndarray, " n"]) -> Bool[np.ndarray, " n"]:
        """Return in which cells an agent that holds an instance can make a half turn, to the left or to the right."""
        place, radius = self.graph.place[cells], self.radius(instance)
        begin = np.arctan2(*(self._boxes[instance].mean(axis=0) - place)[:, 1::-1].T)
        yaw = begin[:, None] + np.linspace(-np.pi, np.pi, 2 * HEADINGS + 1)
        ahead = self.bank.spec.agent_radius + CARRY + radius + APART
        way = np.stack([np.cos(yaw), np.sin(yaw), np.zeros_like(yaw)], axis=-1)
        gap = self._gaps_carrying(instance, (place[:, None] + ahead * way).reshape(-1, 3)).reshape(yaw.shape)
        free = gap > radius - SLACK
        return np.logical_or(free[:, : HEADINGS + 1].all(axis=1), free[:, HEADINGS:].all(axis=1))

    def _gaps_carrying(self, instance: int, places: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, " n"]:
        """Return the plan gap from floor points to the nearest box at the height of a carried instance [m]."""
        half = np.float32(np.diff(self._boxes[instance, :, 2]).item() / 2)
        own, eyes = jnp.int32(self.bank.geometry.instance_object[self.house, instance]), self._eyes(places)
        blocks = np.full((-len(eyes) % BLOCK + len(eyes), 3), np.inf, np.float32)
        blocks[: len(eyes)] = eyes
        parts = [
            gaps_carrying(self._device, self._number, jnp.asarray(part), half, own)
            for part in blocks.reshape(-1, BLOCK, 3)
        ]
        return np.concatenate([np.zeros(0), *parts])[: len(eyes)]

    def put(self, instance: int, radius: float) -> Ends:
        """Return the cells from which a hand can put an object of some radius [m] on an instance; may be empty."""

        def there(eyes: Array) -> Array:
            box, size = jnp.asarray(self._boxes[instance], jnp.float32), jnp.float32(radius)
            return put_from(self._device, self._number, eyes, jnp.int32(instance), box, size, jnp.float32(HAND))

        return self._at_hand_of((instance, radius), there)

    @property
    def _number(self) -> Int[Array, ""]:
        return jnp.int32(self.house)

    def _at_hand_of(self, key: tuple[int, float], there: Callable[[Array], Array]) -> Ends:
        """Return the cells within hand reach of an instance whose eye positions pass a test."""
        if key not in self._at_hand:
            box = self._boxes[key[0]]
            cells, away = self.graph.around(box[0], box[1], EVERY * CELLS)
            cells, away = (x[away <= HAND][::EVERY] for x in (cells, away))
            good = np.asarray(there(jnp.asarray(self._padded_eyes(cells), jnp.float32)))[: len(cells)]
            self._at_hand[key] = cells[good], away[good]
        return self._at_hand[key]

    def _padded_eyes(self, cells: Int[np.ndarray, " c"]) -> Float[np.ndarray, "n 3"]:
        """Return eye positions above cells [m], padded with inf to `CELLS` rows."""
        eyes = np.full((CELLS, 3), np.inf)
        eyes[: len(cells)] = self._eyes(self.graph.place[cells])
        return eyes

    def beside(self, instance: int) -> Ends:
        """Return the cells near an instance with a robust view of it: the nearest ones, and up to `REACH` farther.

        Robust: visible from the cell's centre and from all positions of `sight.SHIFTS` around it. Empty if no cell of
        the `CELLS` nearest qualifies, as for an object behind a wall or in a chest.
        """
        if instance not in self._beside:
            box = self._boxes[instance]
            cells, away = self.graph.around(box[0], box[1], CELLS)
            seen = seen_from(self._device, self.house, self._padded_eyes(cells), box)[: len(cells)]
            near = seen & (away <= np.min(away, where=seen, initial=np.inf) + REACH)
            self._beside[instance] = cells[near], away[near]
        return self._beside[instance]

    def can_be_seen(self, thing: Thing) -> bool:
        """Return whether an object is visible from a cell beside it."""
        parts = np.flatnonzero(self.bank.geometry.instance_object[self.house] == thing.object_id)
        return any(len(self.beside(part)[0]) for part in parts.tolist())

    def looks(self, places: Float[np.ndarray, "n 3"], yaw: Float[np.ndarray, " n"]) -> list[dict[int, float]]:
        """Render level views, and return the fraction of the image that each visible object covers, by object id.

        Args:
            places: Positions on the floor [m].
            yaw: Headings [rad].
        """
        images = ids_in_view(self._device, self.house, self._eyes(places), yaw)
        found = [np.unique(image[image >= 0], return_counts=True) for image in images]
        return [dict(zip(ids.tolist(), (counts / images[0].size).tolist(), strict=True)) for ids, counts in found]

    def _eyes(self, places: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
        return places + np.array([0, 0, self.bank.spec.agent_height - BELOW_TOP])


def house_views(bank: HouseBank) -> tuple[HouseView, ...]:
    """Create a view of each house."""
    geometry = bank.geometry
    boxes = np.asarray(_boxes(geometry.instance_pose, geometry.instance_model, geometry.model_box))
    host = bank.replace(geometry=bank.geometry.replace(gpu=None))
    host = host.replace(
        geometry=jax.tree.map(np.asarray, host.geometry),
        navigation=jax.tree.map(np.asarray, host.navigation),
        semantics=np.asarray(bank.semantics),
    )
    return tuple(HouseView(host, house, boxes[house], bank) for house in range(bank.num_houses))


@jax.jit
def _boxes(pose: Array, model: Array, model_box: Array) -> Float[Array, "h i 2 3"]:
    """Compute the world bounds of the instances of all houses [m]."""
    return jax.vmap(jax.vmap(bounds))(pose, model_box[jnp.maximum(model, 0)])
