"""Late reverberation as a `Bake`: `home_mjx.houses.add_bakes` stores its records and puts them into a bank."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from home_mjx.audio_jax.late_reverb.bake.bake import BakeOptions, bake_house
from home_mjx.audio_jax.late_reverb.bake.late_field import LateField, stacked
from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records.sound import LATE_REVERB, LateSound
from home_mjx.schema.compiled import CompiledHouse

VERSION = 9  # raise it whenever the same house and options would give another field


@dataclass(frozen=True)
class LateReverbBake:
    """Late reverberation of houses, for `AudioConfig(late="baked")`.

    Half a minute to a minute and a half per house on two cores.

    Attributes:
        options: Cell size, rays and seed.

    Example:
        >>> bank = add_bakes(bank, houses, LateReverbBake(BakeOptions(seed=1)))  # doctest: +SKIP
    """

    options: BakeOptions = field(default_factory=BakeOptions)
    name = LATE_REVERB
    version = VERSION
    record = LateField
    unused = frozenset(("lights", "gloss", "ground_floor", "lot", "agent_materials"))

    def bake_house(self, bank: HouseBank, index: int, house: CompiledHouse) -> LateField:
        """Trace the late reverberation of one house; arguments as of `Bake.bake_house`.

        Raises:
            ConfigError: The house has no room.
        """
        return bake_house(house, self.options, bank, index)

    def stack(self, records: Sequence[LateField], houses: Sequence[CompiledHouse], bank: HouseBank) -> LateSound:
        """Return the records of all houses as one pytree, padded to the largest."""
        spec = bank.spec
        return stacked(records, [house.doors.rows(spec.num_doors, spec.num_slides) for house in houses])
