"""Light that surfaces and the sky send to points of rooms: probes of radiance, baked once per house."""

from home_mjx.light_probes.bake import LightProbeBake
from home_mjx.light_probes.options import ProbeOptions

__all__ = ["LightProbeBake", "ProbeOptions"]
