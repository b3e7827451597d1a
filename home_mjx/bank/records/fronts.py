"""Fronts of furniture, and the compartments behind them, in which things can be."""

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.records.owners import HouseOwner
from home_mjx.bank.records.physics import Physics
from home_mjx.core.pytree import Pytree, array


def front_rows(at: HouseOwner) -> Int[np.ndarray, " fronts"]:
    """Return the rows, along the house's padded `doors` axis, of fronts of furniture."""
    return at.door_row[at.house.doors.is_front]


def compartment_doors(at: HouseOwner) -> Int[np.ndarray, " compartments"]:
    """Return the row of each compartment's front along the house's padded `doors` axis."""
    return at.door_row[at.house.compartments.leaf]


class Fronts(Pytree):
    """Fronts of furniture: rows of `Physics`' doors that are not between rooms."""

    leaf: Int[Array, "h fronts"] = array("row along the axis `doors`; -1 padding", source=front_rows, fill=-1)

    @property
    def is_empty(self) -> bool:
        """True if no house has fronts; programs then contain no code for them."""
        return self.leaf.shape[-1] == 0

    def mask(self, physics: Physics, house: Int[Array, ""] | int) -> Bool[Array, " doors"]:
        """Return which leaves of a house, by its index, are fronts of furniture."""
        count = physics.door_valid.shape[1]
        return jnp.any(self.leaf[house][:, None] == jnp.arange(count, dtype=jnp.int32)[None], axis=0)

    def open_doors(self, physics: Physics, house: Int[Array, ""] | int) -> Float[Array, " doors"]:
        """Return joint coordinates of a house with all doors fully open, but fronts of furniture closed."""
        wide = jnp.asarray(physics.door_fully_open[house])
        return wide if self.is_empty else jnp.where(self.mask(physics, house), physics.door_closed[house], wide)


class CompartmentArrays(Pytree):
    """Free boxes behind fronts: of cabinets with shelves between them, and of drawers, which move."""

    door: Int[Array, "h compartments"] = array(
        "row of its front along `doors`; -1 padding", source=compartment_doors, fill=-1
    )
    pos: Float[Array, "h compartments 3"] = array("[m], centre; drawers are shut", source="compartments.pos")
    quat: Float[Array, "h compartments 4"] = array(
        "wxyz, about z only", source="compartments.quat", fill=np.eye(1, 4)[0]
    )
    size: Float[Array, "h compartments 3"] = array(
        "[m], half extents; negative in padding", source="compartments.size", fill=-1
    )

    @property
    def is_empty(self) -> bool:
        """True if no house has compartments."""
        return self.door.shape[-1] == 0

    def centers(
        self, physics: Physics, house: Int[Array, ""] | int, door_angle: Float[Array, " doors"]
    ) -> Float[Array, "compartments 3"]:
        """Return the centres of a house's compartments [m] at joint coordinates: those of drawers move with them."""
        door = jnp.maximum(self.door[house], 0)
        away = (door_angle - physics.door_closed[house])[door, None] * physics.door_slide[house][door]
        return self.pos[house].at[:, :2].add(away)
