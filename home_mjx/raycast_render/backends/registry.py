"""Registry of the backends, which share one signature, and their selection by name or platform."""

import functools
from collections.abc import Callable

from jaxtyping import Array, Int

from home_mjx.bank.records import Geometry
from home_mjx.core.checks import check_known
from home_mjx.core.native.kernel import Kernel
from home_mjx.raycast_render.backends.cpu import TARGET, cast_cpu, compile_chunks
from home_mjx.raycast_render.backends.cuda import cast_cuda, compile_kernels
from home_mjx.raycast_render.backends.self_test import find_fault
from home_mjx.raycast_render.backends.xla import cast_xla
from home_mjx.raycast_render.scene.types import DynamicInstances, RawHit, RayQuery, Rays

RayBackend = Callable[[Geometry, Array, DynamicInstances, Rays, RayQuery], RawHit]
"""(geometry, house (e), moving (e ...), rays (e r ...), query) -> hits (e r), or (e r steps).

Ray [e, r] belongs to environment e.
"""

NATIVE: dict[str, RayBackend] = {"cpu": cast_cpu, "cuda": cast_cuda}  # by platform, where `KERNEL` works
KERNEL = Kernel(
    TARGET,
    "falling back to the slower `xla` backend for ray casts",
    cpu=compile_chunks,
    cuda=compile_kernels,
    test=lambda platform: find_fault(NATIVE[platform]),
)


def cast_auto(
    geometry: Geometry, house: Int[Array, " e"], moving: DynamicInstances, rays: Rays, query: RayQuery
) -> RawHit:
    """Cast, as a `RayBackend`, by the native kernel of the platform of lowering; if none works there, by `cast_xla`."""
    native = {platform: _with_query(cast, query) for platform, cast in NATIVE.items()}
    return KERNEL.select(_with_query(cast_xla, query), native, geometry, house, moving, rays)


def _with_query(backend: RayBackend, query: RayQuery) -> Callable[..., RawHit]:
    """Bind the query of a backend."""
    return lambda geometry, house, moving, rays: backend(geometry, house, moving, rays, query)


def _cast_natively(
    platform: str, geometry: Geometry, house: Array, moving: DynamicInstances, rays: Rays, query: RayQuery
) -> RawHit:
    """Cast with the native backend of "cpu" or "cuda"; raise `BackendError` if it does not work in this process."""
    KERNEL.check_usable(platform, f"the `{platform}` backend", "Use backend='xla'.")
    return NATIVE[platform](geometry, house, moving, rays, query)


BACKENDS: dict[str | None, RayBackend] = {None: cast_auto, "xla": cast_xla}
BACKENDS |= {platform: functools.partial(_cast_natively, platform) for platform in NATIVE}


def find_backend(name: str | None) -> RayBackend:
    """Return the backend `xla`, `cpu` or `cuda`; None: the one that selects by platform, `cast_auto`.

    Raises:
        ConfigError: The backend is unknown.
    """
    check_known("backend", [] if name is None else [name], [n for n in BACKENDS if n])
    return BACKENDS[name]
