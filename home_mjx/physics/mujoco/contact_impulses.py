"""Contact impulses and contact partners of a physics step of C MuJoCo."""

from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float, Int

from home_mjx.physics.base.layout import Layout
from home_mjx.physics.base.state import FLOOR, MIN_SUPPORT_NORMAL, NOTHING, STATIC


class ContactReport(NamedTuple):
    """Contacts of each dynamic body, see `PhysicsState`; `num_contacts` is per agent."""

    num_contacts: Int[np.ndarray, " a"]  # contact points except with floors, see `MIN_SUPPORT_NORMAL`
    impulse: Float[np.ndarray, " m"]  # [N s], of all contacts
    strongest: Float[np.ndarray, " m"]  # [N s], of the strongest contact
    contact_pos: Float[np.ndarray, "m 3"]  # [m], of the strongest contact
    contact_partner: Int[np.ndarray, " m"]  # other side of the strongest contact


def collect_contacts(data: Any, owner: Int[np.ndarray, " g"], layout: Layout, dt: float) -> ContactReport:
    """Collect contact impulses and counts of a `mujoco.MjData`'s last physics step; 0 and `NOTHING` without impulse.

    Each dynamic body has the sum of its normal impulses, and impulse, position and other side of its strongest contact
    point. Of equal ones it is the last; points with the body as second geom follow all others.

    Agents have counts of points, also of those without impulse. Points on floors do not count. Neither do those on
    static boxes whose normal is upward by at least `MIN_SUPPORT_NORMAL`: ramps, tops and edges of steps.

    `owner` has the dynamic body of each geom, or a code of `base.state`. Contacts with geoms of code `NOTHING` count
    like others, but leave `contact_partner` at `NOTHING`. `dt` is the length of the step [s].
    """
    contact, mobiles = data.contact, layout.num_dynamic
    one, two = owner[contact.geom].reshape(-1, 2).T
    me, other = np.concatenate([one, two]), np.concatenate([two, one])
    upward = np.concatenate([-contact.frame[:, 2], contact.frame[:, 2]])  # of the normal towards each side
    carries = (other == FLOOR) | ((other <= STATIC) & (upward >= MIN_SUPPORT_NORMAL))
    met = me[~carries & (me >= 0)]
    count = np.bincount(met, minlength=mobiles)[: layout.num_agents]
    impulse = np.tile(_normal_forces(data) * dt, 2)
    rows = np.flatnonzero((me >= 0) & (impulse > 0))
    rows = rows[np.argsort(impulse[rows], kind="stable")]  # the last write per dynamic body wins: the strongest contact
    strongest, place, partner = np.zeros(mobiles), np.zeros((mobiles, 3)), np.full(mobiles, NOTHING)
    strongest[me[rows]], partner[me[rows]] = impulse[rows], other[rows]
    place[me[rows]] = contact.pos[rows % max(len(one), 1)]
    total = np.bincount(me[rows], impulse[rows], mobiles)
    return ContactReport(count, total, strongest, place, partner)


def _normal_forces(data: Any) -> Float[np.ndarray, " n"]:
    """Return the normal force of each contact [N]: the sum over its constraint rows; 0 for a contact without rows.

    A frictionless contact has one row; one of `condim` 3 has four, the edges of a pyramid. Elliptic cones, whose rows
    are not alike, are not supported.
    """
    contact = data.contact
    sums = np.concatenate([np.zeros(1), np.cumsum(data.efc_force)])
    first = np.maximum(contact.efc_address, 0)
    rows = np.where(contact.dim == 1, 1, 2 * (contact.dim - 1)) * (contact.efc_address >= 0)
    return sums[first + rows] - sums[first]
