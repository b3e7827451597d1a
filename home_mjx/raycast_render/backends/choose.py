"""Registry of the executors, which share one signature, and their selection by name or platform."""

import functools
from collections.abc import Callable

from jaxtyping import Array, Int

from home_mjx.bank.records import Geometry
from home_mjx.core.checks import check_known
from home_mjx.core.native.platforms import select_at_lowering
from home_mjx.raycast_render.backends.cpu import cast_cpu, cpu_available
from home_mjx.raycast_render.backends.cuda import cast_cuda, cuda_available
from home_mjx.raycast_render.backends.xla import cast_xla
from home_mjx.raycast_render.scene.types import DynamicInstances, RawHit, RayQuery, Rays

RayBackend = Callable[[Geometry, Array, DynamicInstances, Rays, RayQuery], RawHit]
"""(geometry, house (e), moving (e ...), rays (e r ...), query) -> hits (e r), or (e r steps).

Ray [e, r] belongs to environment e.
"""


def cast_auto(
    geometry: Geometry, house: Int[Array, " e"], moving: DynamicInstances, rays: Rays, query: RayQuery
) -> RawHit:
    """Cast with the fastest executor of the platform that the program is lowered for."""
    branches = {name: functools.partial(cast, query=query) for name, cast in _native_backends().items()}
    return select_at_lowering(functools.partial(cast_xla, query=query), branches, geometry, house, moving, rays)


def _native_backends() -> dict[str, Callable[..., RawHit]]:
    cpu = {"cpu": cast_cpu} if cpu_available() else {}
    return cpu | ({"cuda": cast_cuda} if cuda_available() else {})


BACKENDS: dict[str | None, RayBackend] = {None: cast_auto, "xla": cast_xla, "cpu": cast_cpu, "cuda": cast_cuda}


def find_backend(name: str | None) -> RayBackend:
    """Return the executor of a name; None selects by platform.

    Raises:
        ConfigError: The executor is unknown.
    """
    check_known("executor", [] if name is None else [name], [n for n in BACKENDS if n])
    return BACKENDS[name]
