"""Reports of contacts dropped because a fixed-size buffer of a physics step overflowed.

MJX tests a limited number of geom pairs of each kind, those with the nearest bounding spheres. It passes a limited
number of contact points to the solver, the deepest ones. Both limits are in the template's MJCF (`max_geom_pairs`,
`max_contact_points`).
"""

import functools
from collections import defaultdict
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
from jaxtyping import Array, Bool, Float, Int
from mujoco import mjx

from home_mjx.core.pytree import Pytree

BOX, CAPSULE = int(mujoco.mjtGeom.mjGEOM_BOX), int(mujoco.mjtGeom.mjGEOM_CAPSULE)  # pyright: ignore[reportAttributeAccessIssue]


class GeomSizes(Pytree):
    """Sizes of all geoms of the stepped model, with filled contact slots."""

    size: Float[Array, "g 3"]  # [m], MuJoCo's `geom_size`
    rbound: Float[Array, " g"]  # [m], radius of the bounding sphere


class Overflow(Pytree):
    """Overflow flags of a control step; True means that contacts may have been dropped."""

    static_boxes: Bool[Array, "..."]  # an owner touches more static boxes than it has slots
    contact_pairs: Bool[Array, "..."]  # the broad phase skipped a touching pair
    contact_points: Bool[Array, "..."]  # more contact points than the solver accepts


def numeric_limit(model: Any, name: str) -> int:
    """Return the first value of a `mujoco.MjModel`'s custom numeric, such as `max_geom_pairs`, as an integer.

    A missing name raises `KeyError`.
    """
    return int(model.numeric(name).data[0])


def are_points_full(data: mjx.Data, max_points: int) -> Bool[Array, ""]:
    """Return whether MJX may have dropped contact points in its last physics step.

    That is if all entries of one `condim` in MJX's contact array penetrate and they are at least `max_points`. It can
    be True without a loss. A `condim` with fewer entries never overflows.
    """
    contact = data._impl.contact  # pyright: ignore[reportAttributeAccessIssue]
    dims = np.asarray(contact.dim)
    full = [contact.dist[dims == dim] for dim in np.unique(dims) if (dims == dim).sum() >= max_points]
    return jnp.any(jnp.stack([jnp.all(dist < 0) for dist in full])) if full else jnp.zeros((), bool)


_sum = functools.partial(jnp.einsum, precision="highest")


@dataclass(frozen=True)
class GeomPairs:
    """Geom pairs of the kinds of which MJX tests only some.

    Attributes:
        groups: Geoms of the pairs (p, 2), one array per kind.
        max_tested: Maximum number of pairs of a kind that MJX tests.
        capsules: Geoms that are capsules.
    """

    groups: tuple[Int[np.ndarray, "_ 2"], ...]
    max_tested: int
    capsules: Int[np.ndarray, " c"]

    @classmethod
    def from_model(cls, model: Any) -> "GeomPairs":
        """Group a `mujoco.MjModel`'s explicit box-box and box-capsule pairs; keep kinds of more than `max_geom_pairs`.

        Pairs that touch by masks (`contype`) are left out. The model must have that numeric.
        """
        most, kinds = numeric_limit(model, "max_geom_pairs"), defaultdict(list)
        for a, b in zip(model.pair_geom1.tolist(), model.pair_geom2.tolist(), strict=True):
            kind = frozenset((int(model.geom_type[a]), int(model.geom_type[b])))
            if kind in ({BOX}, {BOX, CAPSULE}):
                kinds[kind].append((a, b))
        groups = tuple(np.array(pairs) for pairs in kinds.values() if len(pairs) > most)
        return cls(groups, most, np.flatnonzero(model.geom_type == CAPSULE))

    def find_overflow(self, sizes: GeomSizes, data: mjx.Data) -> Bool[Array, ""]:
        """Return whether a pair overlaps that MJX did not test in the last physics step, at the poses of its start.

        These poses are `data.geom_xpos` and `geom_xmat`, not `qpos`. Only pairs of `groups` count, capsules as their
        bounding boxes; False if there are no groups.
        """
        missed = [jnp.any(self._touch(sizes, data, self._untested(sizes, data, pairs))) for pairs in self.groups]
        return jnp.any(jnp.stack(missed)) if missed else jnp.zeros((), bool)

    def _untested(self, sizes: GeomSizes, data: mjx.Data, pairs: Int[np.ndarray, "p 2"]) -> Int[Array, "q 2"]:
        """Return the pairs that MJX skips: all but the `max_tested` with the nearest bounding spheres.

        Of equally near ones, the later are skipped. `pairs` is one kind with more than `max_tested` rows.
        """
        first, second = data.geom_xpos[pairs[:, 0]], data.geom_xpos[pairs[:, 1]]
        apart = jnp.linalg.norm(second - first, axis=-1) - sizes.rbound[pairs].sum(axis=-1)
        _, order = jax.lax.top_k(-apart, len(pairs))
        return jnp.asarray(pairs)[order[self.max_tested :]]

    def _touch(self, sizes: GeomSizes, data: mjx.Data, pairs: Int[Array, "q 2"]) -> Bool[Array, " q"]:
        """Return whether the two boxes of each pair overlap along all six face axes; capsules as bounding boxes.

        Edge pairs are not tested, so it can be True for boxes that are apart; boxes that only touch are False.
        """
        boxes = self._boxes(sizes)
        between = data.geom_xpos[pairs[:, 1]] - data.geom_xpos[pairs[:, 0]]
        a, b = data.geom_xmat[pairs[:, 0]], data.geom_xmat[pairs[:, 1]]
        half_a, half_b = boxes[pairs[:, 0]], boxes[pairs[:, 1]]
        cosine = jnp.abs(_sum("qki,qkj->qij", a, b))
        along_a = jnp.abs(_sum("qk,qki->qi", between, a)) - half_a - _sum("qij,qj->qi", cosine, half_b)
        along_b = jnp.abs(_sum("qk,qkj->qj", between, b)) - half_b - _sum("qij,qi->qj", cosine, half_a)
        return jnp.maximum(along_a.max(axis=-1), along_b.max(axis=-1)) < 0

    def _boxes(self, sizes: GeomSizes) -> Float[Array, "g 3"]:
        """Return half extents of the bounding box of boxes and capsules [m]; `geom_size` of other geoms."""
        size, capsules = sizes.size, self.capsules
        around = jnp.stack([size[capsules, 0], size[capsules, 0], size[capsules, 0] + size[capsules, 1]], axis=-1)
        return size.at[capsules].set(around)
