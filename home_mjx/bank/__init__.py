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
    "declarations",
]
