"""Many compiled houses as one pytree on the device."""

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records import Acoustics, BankSpec, Finish, Geometry, Lights, Materials, Navigation, Physics, schema
from home_mjx.bank.usage import Usage, bank_bytes, bank_usage, planned_bytes

__all__ = [
    "Acoustics",
    "BankSpec",
    "Finish",
    "Geometry",
    "HouseBank",
    "Lights",
    "Materials",
    "Navigation",
    "Physics",
    "Usage",
    "bank_bytes",
    "bank_usage",
    "planned_bytes",
    "schema",
]
