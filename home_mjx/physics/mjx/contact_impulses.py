"""Contact impulses and contact partners of a physics step of MJX."""

from typing import Any

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int
from mujoco import mjx

from home_mjx.core.pytree import Pytree
from home_mjx.physics.base.state import FLOOR, MIN_SUPPORT_NORMAL, NOTHING, STATIC
from home_mjx.physics.mjx.template import Template


class ContactImpulses(Pytree):
    """Contacts of each dynamic body; see `PhysicsState`."""

    impulse: Float[Array, "*t m"]  # [N s], of all contacts
    strongest: Float[Array, "*t m"]  # [N s], of the strongest contact
    contact_pos: Float[Array, "*t m 3"]  # [m], of the strongest contact
    contact_partner: Int[Array, "*t m"]  # other side of the strongest contact


def collect_impulses(template: Template, data: mjx.Data, slot_box: Int[Array, " s"]) -> ContactImpulses:
    """Return each dynamic body's contacts in one physics step of MJX; 0 and `NOTHING` for bodies without impulse.

    They are the sum of normal impulses [N s]; and the impulse, position [m] and partner of the strongest contact point.
    Of equal ones it is the first in MJX's order. `slot_box` is the index of the static box in each slot. `data` is the
    result of `mjx.step`.
    """
    contact, first, second = _contact_sides(template, data, slot_box)
    impulse = _normal_forces(data) * jnp.float32(template.config.timing.sim_dt)
    mobile = jnp.arange(template.layout.num_dynamic, dtype=jnp.int32)
    is_first, is_second = first[:, None] == mobile[None], second[:, None] == mobile[None]
    own = jnp.where(is_first | is_second, impulse[:, None], 0.0)
    best = jnp.argmax(own, axis=0)
    strongest = own[best, mobile]
    other = jnp.where(is_first[best, mobile], second[best], first[best])
    return ContactImpulses(
        impulse=own.sum(axis=0),
        strongest=strongest,
        contact_pos=jnp.where((strongest > 0)[:, None], contact.pos[best], 0.0),
        contact_partner=jnp.where(strongest > 0, other, NOTHING),
    )


def count_contacts(template: Template, data: mjx.Data, slot_box: Int[Array, " s"]) -> Int[Array, " a"]:
    """Count each agent's penetrating contact points in a physics step, also those without impulse.

    Points on the floor plane do not count. Neither do those on a static box, a low table too, if the normal towards
    the agent has an upward part of at least `MIN_SUPPORT_NORMAL`. A point between two agents counts for both. Points
    that MJX dropped are missing. `slot_box` is the index of the static box in each slot.
    """
    contact, first, second = _contact_sides(template, data, slot_box)
    upward = contact.frame[:, 0, 2]  # of the normal, from the first side to the second one
    agent = jnp.arange(template.layout.num_agents, dtype=jnp.int32)

    def count(me: Int[Array, " n"], other: Int[Array, " n"], rise: Float[Array, " n"]) -> Int[Array, " a"]:
        """Count contacts per agent in `me`, where `rise` is the upward part of the normal from `other`."""
        carries = (other == FLOOR) | ((other <= STATIC) & (rise >= jnp.float32(MIN_SUPPORT_NORMAL)))
        touches = (contact.dist < 0) & ~carries
        return jnp.sum((me[:, None] == agent[None]) & touches[:, None], axis=0, dtype=jnp.int32)

    return count(first, second, -upward) + count(second, first, upward)


def combine_substeps(pushes: ContactImpulses) -> ContactImpulses:
    """Combine the physics steps, along the leading axis: sum each body's impulses and keep its strongest contact.

    All fields have exactly one leading axis. Of equally strong contacts, the earliest is kept; `strongest` is the
    impulse in its own step.
    """
    best = jnp.argmax(pushes.strongest, axis=0)
    mobile = jnp.arange(best.shape[0], dtype=jnp.int32)
    return ContactImpulses(
        pushes.impulse.sum(axis=0),
        *(x[best, mobile] for x in (pushes.strongest, pushes.contact_pos, pushes.contact_partner)),
    )


def _contact_sides(
    template: Template, data: mjx.Data, slot_box: Int[Array, " s"]
) -> tuple[Any, Int[Array, " n"], Int[Array, " n"]]:
    """Return MJX's contacts, and the owner of the first and of the second geom of each, coded as in `_owner_codes`.

    MJX's arrays have a fixed length: contacts with a distance of at least 0 are included.
    """
    contact = data._impl.contact  # pyright: ignore[reportAttributeAccessIssue]
    code = _owner_codes(template, slot_box)
    return contact, code[contact.geom[:, 0]], code[contact.geom[:, 1]]


def _owner_codes(template: Template, slot_box: Int[Array, " s"]) -> Int[Array, " g"]:
    """Return each geom's owner: its dynamic body, `FLOOR`, or `STATIC - c` for a slot that contains static box c.

    Geom 0 is the floor. Parked slots have the code of the box in `slot_box`, too.
    """
    mobile = jnp.asarray(template.geom_body).at[0].set(FLOOR)
    return mobile.at[template.layout.slots].set(STATIC - slot_box)


def _normal_forces(data: mjx.Data) -> Float[Array, " n"]:
    """Return the normal force of each contact [N]: the sum over its constraint rows.

    A frictionless contact has one row; any other has four, the edges of a pyramid of `condim` 3. A contact without rows
    has 0. Higher `condim` and elliptic cones are not supported.
    """
    contact, forces = data._impl.contact, data._impl.efc_force  # pyright: ignore[reportAttributeAccessIssue]
    rows = np.where(np.asarray(contact.dim) == 1, 1, 4)[:, None]
    address = np.asarray(contact.efc_address)[:, None] + np.arange(4)
    used = (np.arange(4) < rows) & (address >= 0)
    return jnp.where(used, forces[np.where(used, address, 0)], 0.0).sum(axis=-1)
