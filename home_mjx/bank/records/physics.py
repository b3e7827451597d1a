"""Static boxes, movable bodies, doors and ramps for physics."""

from collections.abc import Callable
from typing import Any

import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.records.owners import HouseOwner
from home_mjx.core.pytree import Pytree, array
from home_mjx.geometry.boxes import box_inertia
from home_mjx.schema.contact_materials import DEFAULT_CONTACT, damping_ratio

PADDING_POS = np.array([0.0, 0.0, -100.0])  # [m], position of padded boxes, far below any house
IDENTITY_QUAT = np.array([1.0, 0.0, 0.0, 0.0])
PADDING_SIZE = np.full(3, 0.1, np.float32)  # [m], half extents of padded boxes


def is_body(at: HouseOwner) -> Bool[np.ndarray, " k"]:
    """Return the mask of movable bodies: True for each body of the house; padding is False."""
    return np.ones(len(at.house.bodies.mass), bool)


def box_inertias(at: HouseOwner) -> Float[np.ndarray, "k 3"]:
    """Return the bodies' principal inertias as solid boxes [kg m^2], about their own axes.

    They are computed from mass and half extents that are first rounded to float32.
    """
    bodies = at.house.bodies
    return box_inertia(bodies.mass.astype(np.float32), bodies.size.astype(np.float32))


def no_arrangement(at: HouseOwner) -> Float[np.ndarray, "0 k 7"]:
    """Return an array of no arrangements; `arrangements.with_arrangements` adds some to a complete bank."""
    return np.zeros((0, len(at.house.bodies.mass), 7))


def damping_ratios(at: HouseOwner) -> Float[np.ndarray, " k"]:
    """Return the damping ratio of each body's contacts, from its restitution; 1: no bounce."""
    return np.array([damping_ratio(e) for e in at.house.bodies.restitution.tolist()])


def ramp_rows(at: HouseOwner) -> Float[np.ndarray, "r 8"]:
    """Return each ramp's top [m]: centre x, y, uphill x, y, half length and width in plan, centre z, rise / run."""
    ramps = at.house.ramps
    slope = ramps.slope[:, None]
    top = ramps.pos + ramps.size[:, 2:] * np.concatenate([-np.sin(slope) * ramps.up, np.cos(slope)], axis=1)
    halves = ramps.size[:, :1] * np.cos(slope), ramps.size[:, 1:2]
    return np.concatenate([top[:, :2], ramps.up, *halves, top[:, 2:], np.tan(slope)], axis=1)


def is_door(at: HouseOwner) -> Bool[np.ndarray, " doors"]:
    """Return the mask of rows of the house's padded `doors` axis that hold a leaf, see `HouseOwner.door_row`."""
    valid = np.zeros(at.sizes["doors"], bool)
    valid[at.door_row] = True
    return valid


def slide_axes(at: HouseOwner) -> Float[np.ndarray, "doors 2"]:
    """Return unit slide directions in plan along the house's padded `doors` axis, see `HouseOwner.door_row`.

    They are 0 in hinged rows, and (1, 0) in unused sliding rows.
    """
    axes = np.zeros((at.sizes["doors"], 2))
    axes[at.sizes["doors"] - at.sizes["slides"] :] = [1.0, 0.0]
    axes[at.door_row] = at.house.doors.slide
    return axes


def door_source(field: str, fill: Any = 0) -> Callable[[HouseOwner], np.ndarray]:
    """Return a function of an owner that lists a field of its doors along the house's padded `doors` axis.

    Rows are those of `HouseOwner.door_row`; rows without a leaf are `fill`.
    """

    def rows(at: HouseOwner) -> np.ndarray:
        """Return the field along the house's padded `doors` axis."""
        values = getattr(at.house.doors, field)
        padded = np.empty((at.sizes["doors"], *values.shape[1:]), values.dtype)
        padded[...] = fill
        padded[at.door_row] = values
        return padded

    rows.__name__ = f"door_{field}"
    return rows


def tray_source(field: str, fill: float) -> Callable[[HouseOwner], np.ndarray]:
    """Return a function of an owner that lists a field of its leaves' trays along the house's padded `slides` axis.

    Rows are those of `HouseOwner.door_row`, less the hinged ones; what is missing is `fill`.
    """

    def rows(at: HouseOwner) -> Float[np.ndarray, "slides tray_boxes 3"]:
        """Return the field along the house's padded `slides` axis."""
        doors, slides = at.house.doors, at.sizes["slides"]
        padded = np.full((slides, at.sizes["tray_boxes"], 3), float(fill))
        if doors.num_tray_boxes:
            row, own = at.door_row - (at.sizes["doors"] - slides), doors.is_sliding
            padded[row[own], : doors.num_tray_boxes] = getattr(doors, field)[own]
        return padded

    rows.__name__ = field
    return rows


class Physics(Pytree):
    """Static boxes, movable bodies, door leaves and ramps over stairs of every house."""

    floor: Float[Array, " h"] = array("[m], top of the ground floor", source="ground_floor")
    fence_rectangle: Float[Array, "h 2 2"] = array("[m], minimum and maximum x and y inside the fence", source="lot")
    collider_pos: Float[Array, "h colliders 3"] = array(
        "[m]; padding is parked far below", source="colliders.pos", fill=PADDING_POS
    )
    collider_quat: Float[Array, "h colliders 4"] = array("wxyz", source="colliders.quat", fill=IDENTITY_QUAT)
    collider_size: Float[Array, "h colliders 3"] = array(
        "[m], half extents", source="colliders.size", fill=PADDING_SIZE
    )
    collider_object: Int[Array, "h colliders"] = array(
        "object id; -1 architecture, barriers and padding", source="colliders.object_id", fill=-1
    )
    body_valid: Bool[Array, "h bodies"] = array("False padding", source=is_body, fill=False)
    body_instance: Int[Array, "h bodies"] = array("-1 padding", source="bodies.instance", fill=-1)
    body_pos: Float[Array, "h bodies 3"] = array(
        "[m]; padding is parked far below", source="bodies.pos", fill=PADDING_POS
    )
    body_quat: Float[Array, "h bodies 4"] = array("wxyz", source="bodies.quat", fill=IDENTITY_QUAT)
    body_size: Float[Array, "h bodies 3"] = array("[m], half extents", source="bodies.size", fill=PADDING_SIZE)
    body_mass: Float[Array, "h bodies"] = array("[kg]", source="bodies.mass", fill=1)
    body_inertia: Float[Array, "h bodies 3"] = array(
        "[kg m^2], principal", source=box_inertias, fill=box_inertia(np.ones(1, np.float32), PADDING_SIZE[None])[0]
    )
    body_friction: Float[Array, "h bodies"] = array("sliding", source="bodies.friction", fill=DEFAULT_CONTACT.friction)
    body_damping_ratio: Float[Array, "h bodies"] = array("of its contacts; 1: no bounce", source=damping_ratios, fill=1)
    body_from_model: Float[Array, "h bodies 3 4"] = array(
        "body frame from model frame", source="bodies.from_model", fill=np.eye(3, 4)
    )
    arrangement_pose: Float[Array, "h arrangements bodies 7"] = array(
        "[m] and wxyz, alternative poses with all bodies at rest; initially empty, see `arrangements`",
        source=no_arrangement,
        fill=np.concatenate([PADDING_POS, IDENTITY_QUAT]),
    )
    door_valid: Bool[Array, "h doors"] = array("False padding", source=is_door, fill=False)
    door_instance: Int[Array, "h doors"] = array("-1 padding", source=door_source("instance", -1), fill=-1)
    door_pivot: Float[Array, "h doors 2"] = array(
        "[m], position of the hinge in plan; centre of a sliding leaf", source=door_source("pivot")
    )
    door_slide: Float[Array, "h doors 2"] = array(
        "unit direction of sliding; 0 for hinged leaves, which come first", source=slide_axes
    )
    door_closed: Float[Array, "h doors"] = array(
        "[rad] about +z, or [m] for sliding leaves; closed, relative to as authored", source=door_source("closed")
    )
    door_fully_open: Float[Array, "h doors"] = array("[rad] or [m], fully open", source=door_source("fully_open"))
    door_low: Float[Array, "h doors"] = array("[rad] or [m], minimum", source=door_source("low"))
    door_high: Float[Array, "h doors"] = array("[rad] or [m], maximum", source=door_source("high"))
    door_pos: Float[Array, "h doors 3"] = array("[m], centre of the leaf as authored", source=door_source("pos"))
    door_quat: Float[Array, "h doors 4"] = array(
        "wxyz, about z only", source=door_source("quat", IDENTITY_QUAT), fill=IDENTITY_QUAT
    )
    door_size: Float[Array, "h doors 3"] = array(
        "[m], half extents", source=door_source("size", PADDING_SIZE), fill=PADDING_SIZE
    )
    door_mass: Float[Array, "h doors"] = array("[kg]", source=door_source("mass", 1), fill=1)
    tray_pos: Float[Array, "h slides tray_boxes 3"] = array(
        "[m], boxes of drawers besides their fronts, in the frame of the sliding leaf's box",
        source=tray_source("tray_pos", 0),
    )
    tray_size: Float[Array, "h slides tray_boxes 3"] = array(
        "[m], half extents; negative: no box", source=tray_source("tray_size", -1), fill=-1
    )
    ramp: Float[Array, "h ramps 8"] = array(
        "centre of its top in plan (2) [m], uphill direction (2), half length and width in plan [m], height of the "
        "centre [m], slope (rise / run); padding has a negative length",
        source=ramp_rows,
        fill=np.array([0.0, 0.0, 1.0, 0.0, -1.0, -1.0, 0.0, 0.0]),
    )
    ramp_collider: Int[Array, "h ramps"] = array(
        "static box with the same top; -1 padding", source="ramps.collider", fill=-1
    )
