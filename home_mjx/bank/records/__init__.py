"""Arrays of a bank, grouped by the engine that reads them; each is declared once, at its field (`declaration`)."""

from home_mjx.bank.records.acoustics import Acoustics
from home_mjx.bank.records.bank_arrays import (
    BankArrays,
    BankSpec,
    declarations,
    get_array,
    group_by_record,
    replace_arrays,
)
from home_mjx.bank.records.declaration import Declaration
from home_mjx.bank.records.fronts import CompartmentArrays, Fronts
from home_mjx.bank.records.geometry import Geometry
from home_mjx.bank.records.gpu_geometry import GpuGeometry
from home_mjx.bank.records.lights import Lights
from home_mjx.bank.records.materials import Finish, Materials
from home_mjx.bank.records.navigation import NavigationArrays
from home_mjx.bank.records.physics import Physics
from home_mjx.bank.records.switches import SWITCH_KINDS, Switches

__all__ = [
    "SWITCH_KINDS",
    "Acoustics",
    "BankArrays",
    "BankSpec",
    "CompartmentArrays",
    "Declaration",
    "Finish",
    "Fronts",
    "Geometry",
    "GpuGeometry",
    "Lights",
    "Materials",
    "NavigationArrays",
    "Physics",
    "Switches",
    "declarations",
    "get_array",
    "group_by_record",
    "replace_arrays",
]
