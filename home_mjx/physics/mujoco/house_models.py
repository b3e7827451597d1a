"""The houses of a bank in C MuJoCo, as functions that XLA calls; models are built on first use."""

import functools
import hashlib
import itertools
import threading
from collections import OrderedDict
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor, wait

import mujoco
import numpy as np

from home_mjx.core.native.host_call import register_host_call
from home_mjx.core.workers import usable_cores
from home_mjx.physics.base.config import PhysicsSetup
from home_mjx.physics.base.layout import Layout
from home_mjx.physics.mujoco.house_mjcf import HouseRows, house_mjcf
from home_mjx.physics.mujoco.house_model import MujocoHouse

MAX_CACHED_HOUSES = 1024  # maximum number of cached houses, least recently used evicted first

Arrays = Sequence[np.ndarray]

_count = itertools.count()


class MujocoHouses:
    """Models of houses, and the two host functions that XLA calls on them.

    `find` runs once per control step and maps a house's rows to a number, so that streamed and exchanged banks need no
    special case. Each physics step then refers to its house by that number.

    Attributes:
        layout: Layout of the state.
        find_target: Target of `jax.ffi.ffi_call`. Operands: arrays of all houses in the order of `HouseRows`, then
            the house of each environment (e). Result: the number of each house (e).
        step_target: Operands: numbers (e), `qpos`, `qvel`, `qacc`, applied forces. Results: `qpos`, `qvel`, `qacc`, the
            fields of `ContactReport`, and whether contacts were dropped (e).
    """

    def __init__(self, config: PhysicsSetup, layout: Layout) -> None:
        self._config, self.layout = config, layout
        self._lock = threading.Lock()
        self._numbers: OrderedDict[bytes, int] = OrderedDict()  # by digest of a house's rows; most recently used last
        self._houses: dict[int, MujocoHouse] = {}
        own = next(_count)
        self.find_target, self.step_target = f"home_mjx_c_find_{own}", f"home_mjx_c_step_{own}"
        register_host_call(self.find_target, self._find)
        register_host_call(self.step_target, self._step)

    def _find(self, given: Arrays, results: Arrays) -> None:
        """Write the number of each environment's house, as in `find_target`; build models that are not cached.

        House indices are clipped. Houses with equal rows share a number; numbers are not reused. Then the least
        recently used models beyond `MAX_CACHED_HOUSES` are evicted, but none of this call; their numbers become
        invalid.
        """
        *tables, house = given
        chosen, inverse = np.unique(np.clip(house, 0, len(tables[0]) - 1), return_inverse=True)
        with self._lock:
            numbers = [self._number(HouseRows(*(table[h] for table in tables))) for h in chosen]
            while len(self._numbers) > max(MAX_CACHED_HOUSES, len(chosen)):
                del self._houses[self._numbers.popitem(last=False)[1]]
        results[0][:] = np.array(numbers, np.int32)[inverse.reshape(-1)]

    def _number(self, rows: HouseRows) -> int:
        """Return the number of the house with these rows; build its model if it is not cached.

        Mark it as most recently used; evict nothing. The caller holds the lock.
        """
        digest = hashlib.blake2b(b"".join(np.ascontiguousarray(row).tobytes() for row in rows)).digest()
        number = self._numbers.get(digest)
        if number is None:
            number, house = next(_count), build_house_model(self._config, self.layout, rows)
            self._houses[number], self._numbers[digest] = house, number
        self._numbers.move_to_end(digest)
        return number

    def _step(self, given: Arrays, results: Arrays) -> None:
        """Run a physics step of all environments, at least one, on all cores; the host function of `step_target`.

        Return when all are done. A number whose model was evicted raises `KeyError`.
        """
        envs = np.array_split(np.arange(len(given[0])), min(usable_cores(), len(given[0])))
        if len(envs) == 1:
            return self._step_some(given, results, envs[0])
        steps = [_pool().submit(self._step_some, given, results, some) for some in envs]
        wait(steps)  # all of them before an error is raised: `results` is freed then
        for step in steps:
            step.result()
        return None

    def _step_some(self, given: Arrays, results: Arrays, envs: np.ndarray) -> None:
        """Step the environments with these indices one by one, and write their rows of `results`; keep other rows."""
        for env in envs.tolist():
            number, *state = (x[env] for x in given)
            moved = self._houses[int(number)].step(*state)
            values = *moved[:3], *moved.contacts, moved.has_overflow
            for result, value in zip(results, values, strict=True):
                result[env] = value


def build_house_model(config: PhysicsSetup, layout: Layout, rows: HouseRows) -> MujocoHouse:
    """Build C MuJoCo's model of a house from its rows (`house_mjcf`), with the index maps between model and state.

    Unused bodies and doors, and static boxes without three positive half extents, are left out. The lengths of `rows`
    and the agents of `config` must be those of `layout`.
    """
    model = mujoco.MjModel.from_xml_string(house_mjcf(config, rows))  # pyright: ignore[reportAttributeAccessIssue]
    agents = [f"agent{a}" for a in range(layout.num_agents)]
    bodies = [f"body{k}" if valid else "" for k, valid in enumerate(rows.body_valid)]
    doors = [f"door{h}" if valid else "" for h, valid in enumerate(rows.door_valid)]
    static = {f"static{c}": c for c in np.flatnonzero((rows.collider_size > 0).all(axis=-1)).tolist()}
    return MujocoHouse(model, layout, agents + bodies + doors, static)


class PrebuiltHouses(MujocoHouses):
    """Prebuilt models; the house index of an environment is the index into a list.

    Args:
        config: Options.
        layout: Layout of the state.
        houses: One model for each house of the bank, in its order.
    """

    def __init__(self, config: PhysicsSetup, layout: Layout, houses: Sequence[MujocoHouse]) -> None:
        super().__init__(config, layout)
        self._houses = dict(enumerate(houses))

    def __len__(self) -> int:
        return len(self._houses)

    def _find(self, given: Arrays, results: Arrays) -> None:
        """Write each environment's house index, clipped to the list, as its number; the houses' rows are ignored."""
        np.clip(given[-1], 0, len(self) - 1, out=results[0])


@functools.cache
def shared_house_models(config: PhysicsSetup, layout: Layout) -> MujocoHouses:
    """Return the store of models, built on first use, that all templates of these options and capacities share.

    The process keeps every store to its end.
    """
    return MujocoHouses(config, layout)


@functools.cache
def _pool() -> ThreadPoolExecutor:
    """Return the thread pool that all stores share, made on first use and never shut down."""
    return ThreadPoolExecutor(usable_cores(), "home_mjx_c")
