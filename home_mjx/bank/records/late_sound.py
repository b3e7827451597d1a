"""Late sound of houses, as `audio_jax.baking` has found it."""

import jax
from jaxtyping import Array, Float, Int, Int8, UInt8

from home_mjx.core.pytree import Pytree


class LateSound(Pytree):
    """What is kept of the late sound of every house h, with all doors wide open.

    Rooms are divided into cells. Between two of them sound arrives after `distance` / c; its energy is kept per octave
    for some spans of time after that. Within a span time runs as it does between the cells' rooms, `shape`. Logarithms
    are natural ones. The rest is an energy balance of the rooms, for what doors and walls change.
    """

    distance: Float[Array, "h n n"]  # [m], from cell to cell around what stands in between
    level: Float[Array, "h n n spans bands"]  # logarithm of the energy re the free field at 1 m
    comes_from: Int8[Array, "h n n 3"]  # mean direction to where the second cell hears the first from, in 1 / 127
    room: Int[Array, "h n"]  # of each cell
    shape: Float[Array, "h r r bands knots"]  # logarithm of the energy per time bin, of which each span holds 1
    near: UInt8[Array, "h levels rows columns e"]  # cells around each place
    weight: Float[Array, "h levels rows columns e"]  # of these; they add up to 1
    floor: Float[Array, "h levels"]  # [m]; inf padding
    origin: Float[Array, "h 2"]  # [m], corner of place (0, 0)
    step: Float[Array, " h"]  # [m], between places
    volume: Float[Array, "h r"]  # [m³], of each room
    loss: Float[Array, "h r bands"]  # [1/m], share of a room's energy that its surfaces and air take
    opening: Float[Array, "h r r bands"]  # [m²], exchange of rooms through openings: volume times share per metre
    wall: Float[Array, "h r r bands"]  # [m²], the same through walls
    portal_room: Int[Array, "h p 2"]  # the rooms that each portal joins
    portal_share: Float[Array, "h p"]  # of the exchange of its rooms; 0 padding
    portal_leaf: Int[Array, "h p 2"]  # rows of the leaves that can close it; -1 none
    portal_leak: Float[Array, "h p bands"]  # energy that these let through, as a fraction

    @property
    def nbytes(self) -> int:
        """Bytes of all arrays."""
        return sum(x.nbytes for x in jax.tree.leaves(self))
