"""Light probes as a `Bake`: `home_mjx.houses.add_bakes` stores their records and puts them into a bank."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.packing.capacity import check_fits
from home_mjx.bank.records.lights import LIGHT_PROBES, LightProbes
from home_mjx.light_probes.emitters import check_sources, texture_digest
from home_mjx.light_probes.field import ProbeField, padded_lengths, stack_fields
from home_mjx.light_probes.options import ProbeOptions
from home_mjx.schema.compiled import CompiledHouse

CACHE_VERSION = 8  # raise it whenever the same house and options would give another field


@dataclass(frozen=True)
class LightProbeBake:
    """Light that surfaces and the sky send to the rooms of houses, for the shader `lit`.

    Rays are traced on all cores of the CPU, whatever the device.

    Attributes:
        options: Spacing, rays and seed.

    Example:
        >>> bank = add_bakes(bank, houses, LightProbeBake(ProbeOptions(spacing=0.4)))  # doctest: +SKIP
    """

    options: ProbeOptions = field(default_factory=ProbeOptions)
    name = LIGHT_PROBES
    version = CACHE_VERSION
    platform = "cpu"  # rays are traced on the host, whatever the device
    in_processes = True
    record = ProbeField
    # Products of matrices and powers among these differ in the last bit between processors.
    unused = frozenset(
        (
            *("gloss", "ground_floor", "lot", "agent_materials", "exposed_edges", "colliders", "planes", "ramps"),
            *("bodies", "blocked_objects", "materials.absorption", "materials.scattering", "materials.transmission"),
            "materials.maps",
        )
    )

    def extra_key(self, house: CompiledHouse) -> bytes:
        """Return a digest of the textures' colours and cut-outs; files of one texture differ between encoders.

        Raises:
            DatasetError: The light of a material or lamp is not a number or negative.
        """
        check_sources(house)
        return texture_digest(house)

    def bake_house(self, bank: HouseBank, index: int, house: CompiledHouse) -> ProbeField:
        """Trace the light of one house; arguments as of `Bake.bake_house`. A house without rooms has no probes."""
        from home_mjx.light_probes.solve import solve_house

        return solve_house(bank, index, house, self.options)

    def capacity(self, records: Sequence[ProbeField], capacity_factor: float) -> dict[str, int]:
        """Return the numbers of probes and rooms up to which later houses fit."""
        return padded_lengths(records, capacity_factor)

    def stack(
        self,
        records: Sequence[ProbeField],
        houses: Sequence[CompiledHouse],
        bank: HouseBank,
        capacity: Mapping[str, int] | None = None,
    ) -> LightProbes:
        """Return the records of all houses as one pytree, padded to axis lengths `capacity`; None: to the largest.

        Raises:
            CapacityError: A record does not fit.
        """
        if capacity is not None:
            for house, record in zip(houses, records, strict=True):
                check_fits(house.id, record.lengths, capacity)
        return stack_fields(records, capacity)
