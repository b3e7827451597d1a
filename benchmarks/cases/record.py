"""One measured figure, and what it is measured on."""

from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from home_mjx.core import profiling
from home_mjx.houses import load_bank
from home_mjx.houses.house_set import HouseSet
from home_mjx.schema.compiled import CompiledHouse


@dataclass(frozen=True)
class Record:
    """One figure with all that is needed to judge it.

    Attributes:
        case: Such as `rays/primary-depth`.
        value: The figure.
        unit: Of `value` and `peer_value`.
        num_envs: Environments in the batch; 0 where there is no batch.
        device: What it ran on.
        versions: Of the packages that matter.
        compile_seconds: Tracing and compiling, not part of `value`; None where nothing is compiled.
        peer: Another program that does the same, measured in the same run; None if not installed.
        peer_value: Its figure.
        ratio: `value` / `peer_value`.
        note: The exact work that was timed.
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


def make_record(
    case: str,
    value: float,
    unit: str,
    note: str,
    *,
    num_envs: int = 0,
    compile_seconds: float | None = None,
    peer: tuple[str, float] | None = None,
) -> Record:
    """A record of this machine."""
    name, peer_value = peer or (None, None)
    ratio = value / peer_value if peer_value else None
    device, versions = profiling.device_name(), profiling.versions()
    return Record(case, value, unit, num_envs, device, versions, compile_seconds, name, peer_value, ratio, note)


@dataclass(frozen=True)
class Settings:
    """What to measure on.

    Attributes:
        dataset: Root of a SUNCG dataset; None for generated houses.
        num_houses: Houses in the bank.
        num_envs: Environments in the batch.
        seconds: How long each figure is measured, at least.
    """

    dataset: Path | None = None
    num_houses: int = 8
    num_envs: int = 64
    seconds: float = 2.0

    @cached_property
    def house_set(self) -> HouseSet:
        """Which houses."""
        return house_set(self.dataset or f"procedural:{self.num_houses}", num_houses=self.num_houses)

    @property
    def root(self) -> Path:
        """Root of the dataset."""
        return self.house_set.opened.root

    @cached_property
    def bank(self) -> Any:
        """The houses, on the device."""
        return load_bank(self.house_set, progress=True)

    @cached_property
    def late_bank(self) -> Any:
        """The same with baked late sound."""
        from home_mjx.houses.bakes import add_bakes

        return add_bakes(self.bank, self.house_set.load(), "late_reverb", progress=True)

    @cached_property
    def first_house(self) -> CompiledHouse:
        """The bank's first house, on the host."""
        (house,) = replace(self.house_set, num_houses=1).load()
        return house

    def describe(self, num_houses: int) -> str:
        """So many houses, in words."""
        return f"{num_houses} {f'houses of {self.dataset.name}' if self.dataset else 'generated houses'}"

    @property
    def houses(self) -> str:
        """The bank's houses in words."""
        return self.describe(self.bank.num_houses)
