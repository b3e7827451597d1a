"""Late reverberation as a `Bake`: `home_mjx.houses.add_bakes` stores its records and puts them into a bank."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from home_mjx.audio_jax.late_reverb.bake.late_field import LateField, padded_lengths, stack_fields
from home_mjx.audio_jax.late_reverb.bake.options import DEVICES, BakeOptions, Device
from home_mjx.bank.bank import HouseBank
from home_mjx.bank.packing.capacity import check_fits
from home_mjx.bank.records.acoustics import LATE_REVERB, LateReverb
from home_mjx.core.checks import check_known
from home_mjx.schema.compiled import CompiledHouse

CACHE_VERSION = 10  # raise it whenever the same house and options would give another field


@dataclass(frozen=True)
class LateReverbBake:
    """Late reverberation of houses, for `AudioConfig(late=Baked())`.

    Rays are traced on JAX's first GPU, or else on all cores of the CPU, in a second for a room to 15 CPU seconds for a
    home of ten rooms. Both use one estimator with different random numbers, so their records are equal within its
    noise, and share one place in the store.

    Attributes:
        options: Cell size, rays, seed and quality.
        device: "cpu"; "gpu", which must be there and work; "auto": a GPU if JAX has one, with a warning if it fails its
            test.

    Raises:
        UnknownNameError: The device is unknown.

    Example:
        >>> bank = add_bakes(bank, houses, LateReverbBake(BakeOptions(seed=1)))  # doctest: +SKIP
    """

    options: BakeOptions = field(default_factory=BakeOptions)
    device: Device = "auto"
    name = LATE_REVERB
    version = CACHE_VERSION
    platform = "cpu"  # one record for all devices
    record = LateField
    unused = frozenset(("lights", "gloss", "ground_floor", "lot", "agent_materials", "exposed_edges", "materials.maps"))

    def __post_init__(self) -> None:
        check_known("device", [self.device], DEVICES)

    @property
    def substitutes(self) -> tuple["LateReverbBake", ...]:
        """Bakes whose stored records serve as well: that of fine quality for a coarse one, else none."""
        fine = replace(self.options, quality="fine")
        return (replace(self, options=fine),) if self.options != fine else ()

    def bake_house(self, bank: HouseBank, index: int, house: CompiledHouse) -> LateField:
        """Trace the late reverberation of one house; arguments as of `Bake.bake_house`.

        Raises:
            BackendError: `device` is "gpu" and there is none that works, or a GPU fails.
            ConfigError: The house has no room.
        """
        from home_mjx.audio_jax.late_reverb.bake.bake import bake_house

        return bake_house(house, self.options, bank, index, self.device)

    def capacity(self, records: Sequence[LateField], capacity_factor: float) -> dict[str, int]:
        """Return lengths of axes (cells, rooms, lattice, portals) up to which later houses fit, by `padded_lengths`."""
        return padded_lengths(records, capacity_factor)

    def stack(
        self,
        records: Sequence[LateField],
        houses: Sequence[CompiledHouse],
        bank: HouseBank,
        capacity: Mapping[str, int] | None = None,
    ) -> LateReverb:
        """Return the records of all houses as one pytree, padded to axis lengths `capacity`; None: to the largest.

        Raises:
            CapacityError: A record does not fit.
        """
        if capacity is not None:
            for house, record in zip(houses, records, strict=True):
                check_fits(house.id, record.lengths, capacity)
        spec = bank.spec
        rows = [house.doors.bank_rows(spec.num_doors, spec.num_slides) for house in houses]
        return stack_fields(records, rows, capacity)


COARSE_BAKE = LateReverbBake(BakeOptions(quality="coarse"))  # serves at once where no fine record is stored
