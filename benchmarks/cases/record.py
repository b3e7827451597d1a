"""Record of one measurement, and the settings of a benchmark."""

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from home_mjx.core import profiling
from home_mjx.core.checks import check_number
from home_mjx.houses import load_bank
from home_mjx.houses.house_set import HouseSet
from home_mjx.schema.compiled import CompiledHouse


@dataclass(frozen=True)
class Measurement:
    """One measurement with its context.

    Attributes:
        case: Name such as `rays/primary-depth`.
        value: Measured value.
        unit: Unit of `value` and `peer_value`.
        num_envs: Environments in the batch; 0 without a batch.
        device: Device that it ran on.
        versions: Versions of the relevant packages.
        compile_seconds: Time of tracing and compiling, not part of `value`; None if nothing is compiled.
        peer: Another program for the same work, measured in the same run; None if not installed.
        peer_value: Value of the peer.
        ratio: `value` / `peer_value`.
        note: Exact description of the timed work.
    """

    case: str
    value: float
    unit: str
    num_envs: int
    device: str
    versions: dict[str, str]
    compile_seconds: float | None
    peer: str | None
    peer_value: float | None
    ratio: float | None
    note: str


def make_measurement(
    case: str,
    value: float,
    unit: str,
    note: str,
    *,
    num_envs: int = 0,
    compile_seconds: float | None = None,
    peer: tuple[str, float] | None = None,
) -> Measurement:
    """Build a record with the device and versions of this machine."""
    name, peer_value = peer or (None, None)
    ratio = value / peer_value if peer_value else None
    device, versions = profiling.device_name(), profiling.versions()
    return Measurement(case, value, unit, num_envs, device, versions, compile_seconds, name, peer_value, ratio, note)


@dataclass(frozen=True)
class BenchSettings:
    """Settings of a benchmark.

    Attributes:
        dataset: Root of a SUNCG dataset; None for generated houses.
        num_houses: Houses in the bank.
        num_envs: Environments in the batch.
        seconds: Minimum time of each measurement [s].
    """

    dataset: Path | None = None
    num_houses: int = 8
    num_envs: int = 64
    seconds: float = 2.0

    def __post_init__(self):
        for name in ("num_houses", "num_envs"):
            check_number(name, getattr(self, name), 1, 2**31 - 1, integer=True)
        check_number("seconds", self.seconds, 0)

    @cached_property
    def house_set(self) -> HouseSet:
        """Houses of the benchmark."""
        return HouseSet(self.dataset or f"procedural:{self.num_houses}", num_houses=self.num_houses)

    @property
    def root(self) -> Path:
        """Root of the dataset, whose houses are generated if need be."""
        dataset = self.house_set.resolved_dataset
        dataset.prepare(self.house_set.house_ids)
        return dataset.root

    @cached_property
    def bank(self) -> Any:
        """Houses on the device."""
        return load_bank(self.house_set, progress=True)

    @cached_property
    def late_bank(self) -> Any:
        """Houses on the device with baked late reverberation."""
        from home_mjx.houses.bakes import add_bakes

        return add_bakes(self.bank, self.house_set.load(), "late_reverb", progress=True)

    @cached_property
    def first_house(self) -> CompiledHouse:
        """First house of the bank, on the host."""
        (house,) = replace(self.house_set, num_houses=1).load()
        return house

    def describe(self, num_houses: int) -> str:
        """Return a description of a number of houses."""
        return f"{num_houses} {f'houses of {self.dataset.name}' if self.dataset else 'generated houses'}"

    @property
    def houses(self) -> str:
        """Description of the bank's houses."""
        return self.describe(self.bank.num_houses)
