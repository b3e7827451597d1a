"""The second generator of procedural houses: homes of up to three storeys, in SUNCG's on-disk format."""

from home_mjx.datasets.homes.build import build_home

__all__ = ["build_home"]
