"""Many compiled houses as one pytree on the device."""

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records import (
    Acoustics,
    BankSpec,
    Finish,
    Geometry,
    Lights,
    Materials,
    NavigationArrays,
    Physics,
    declarations,
)
from home_mjx.bank.usage import Usage, bank_bytes, bank_usage, planned_bytes

__all__ = [
    "Acoustics",
    "BankSpec",
    "Finish",
    "Geometry",
    "HouseBank",
    "Lights",
    "Materials",
    "NavigationArrays",
    "Physics",
    "Usage",
    "bank_bytes",
    "bank_usage",
    "declarations",
    "planned_bytes",
]
