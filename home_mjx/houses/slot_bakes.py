"""Baked records of a `HouseStream`, in shapes that never change."""

from collections.abc import Mapping, Sequence
from typing import Any

import jax

from home_mjx.bank.bank import HouseBank
from home_mjx.core.progress import ProgressCount, plural
from home_mjx.errors import CapacityError
from home_mjx.houses.bakes import Bake, SizedBake, find_bakes, make_record, read_record
from home_mjx.schema.compiled import CompiledHouse

Records = Mapping[str, Any]  # of one house, by the name of the bake


class SlotBakes:
    """Bakes of the houses in a `HouseStream`. All houses' records have the capacity that `reserve` sets.

    Args:
        bakes: Bakes or their names.

    Raises:
        ConfigError: A value is not a bake.
        UnknownNameError: No bake has this name.
    """

    def __init__(self, bakes: Bake | str | Sequence[Bake | str]) -> None:
        self._bakes = find_bakes(bakes)
        self._capacity: dict[str, Mapping[str, int]] = {}
        self._layout: Any = None

    def records(self, house: CompiledHouse, count: ProgressCount | None = None) -> Records:
        """Return the records of a house; those not in the store are computed in a bank of this house, and stored.

        Args:
            house: The compiled house.
            count: Progress that describes the computation.
        """
        found = {bake.name: read_record(bake, house) for bake in self._bakes}
        missing = [bake for bake in self._bakes if found[bake.name] is None]
        if not missing:
            return found
        bank = HouseBank.from_compiled([house])
        for bake in missing:
            if count is not None and count.total is not None:
                count.describe(f"baking {bake.name} of {plural(count.total, 'house')} (once, then cached)")
            found[bake.name] = make_record(bake, bank, 0, house)
        return found

    def reserve(
        self, records: Sequence[Records], houses: Sequence[CompiledHouse], bank: HouseBank, capacity_factor: float
    ) -> HouseBank:
        """Return a bank with the records of its first houses, whose shapes later records must have.

        Call it before `pack`. A `SizedBake` pads its records to a capacity, so that larger ones fit; other bakes'
        records are not padded. The bank's earlier bakes are dropped.

        Args:
            records: Records of the bank's houses.
            houses: These houses.
            bank: The bank.
            capacity_factor: Factor of the capacity over the largest of the records.
        """
        for bake in self._bakes:
            if isinstance(bake, SizedBake):
                self._capacity[bake.name] = bake.capacity([own[bake.name] for own in records], capacity_factor)
        self._bank = jax.eval_shape(lambda: bank)
        stacked = self._stack(records, houses)
        self._layout = _layout(stacked)
        return bank.replace(bakes=stacked)

    def pack(self, records: Records, house: CompiledHouse) -> dict[str, Any]:
        """Return the records of a house as the bank has them, with a house axis of length 1.

        Raises:
            CapacityError: A record exceeds the capacity of its `SizedBake`. Or the structure, a shape or a type of one
                differs at all, even by being smaller, from the bank's.
        """
        packed = self._stack([records], [house])
        for name, layout in _layout(packed).items():
            if layout != self._layout[name]:
                message = f"the record of bake `{name}` of house {house.id} has another shape than the first houses'"
                raise CapacityError(message, hint="Give the bake a `capacity`, see `home_mjx.houses.bakes.SizedBake`.")
        return packed

    def _stack(self, records: Sequence[Records], houses: Sequence[CompiledHouse]) -> dict[str, Any]:
        """Return the houses' records by name of the bake, on the device, each stacked along a first axis of houses.

        Those of a `SizedBake` are padded to the capacity that `reserve` sets.

        Raises:
            CapacityError: A record does not fit this capacity.
        """
        return {bake.name: self._stack_one(bake, [own[bake.name] for own in records], houses) for bake in self._bakes}

    def _stack_one(self, bake: Bake, records: Sequence[Any], houses: Sequence[CompiledHouse]) -> Any:
        """Return one bake's records of the houses as `_stack` does."""
        if isinstance(bake, SizedBake):
            return jax.device_put(bake.stack(records, houses, self._bank, self._capacity[bake.name]))
        return jax.device_put(bake.stack(records, houses, self._bank))


def _layout(stacked: Mapping[str, Any]) -> dict[str, Any]:
    """Return the structure, shapes and types of stacked records by bake, without the house axis."""
    return {
        name: (jax.tree.structure(tree), [(leaf.shape[1:], leaf.dtype) for leaf in jax.tree.leaves(tree)])
        for name, tree in stacked.items()
    }
