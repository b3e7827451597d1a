"""Bathrooms and toilets."""

from home_procgen.floor_plan.placed import PlacedFurniture
from home_procgen.floor_plan.walls import FLOOR_TOP
from home_procgen.furnish.space.corners import across_corner, add_corner, in_corner
from home_procgen.furnish.space.hung import above, hang_kind, windows
from home_procgen.furnish.space.on_top import some
from home_procgen.furnish.space.room import Room
from home_procgen.furnish.space.spots import add, against_wall, fit, next_to, place
from home_procgen.style.kinds import models_of

AT_BASIN = (
    *(("soap_dispenser", 0.7), ("soap_dish", 0.4), ("set_toiletries", 0.7), ("cup", 0.15), ("small_plant", 0.15)),
    *(("candle", 0.12), ("hair_dryer", 0.15), ("cloth", 0.15)),
)


def bathroom(room: Room) -> None:
    """Place a tub or a shower first, then a toilet, a basin under a mirror, towels and a washing machine."""
    kinds = room.rng.permutation(["plain_bathtub", "shower"]).tolist()
    if room.plan.area > 7.5 and room.chance(0.1):
        kinds = ["corner_bathtub", *kinds]
    for kind in kinds:
        if washing := fit(room, kind, lambda item: _washing(room, item)):
            _mat(room, washing)
            break
    closet(room)
    basin(room, str(room.rng.choice(["small_basin", "vanity", "vanity"])))
    if room.plan.area > 8.5 and room.chance(0.4):
        fit(room, "shower", lambda item: _washing(room, item))
    if room.plan.area > 8 and room.chance(0.15):
        add(room, "bidet", 0.4)
    if washer := add(room, "washer", 0.4, 0.4):
        some(room, washer, (("cloth", 0.5), ("bottle", 0.3), ("iron", 0.12)), 2)
    add(room, "dryer", 0.4, 0.1)
    for kind, probability in (("paper_bin", 0.45), ("floor_basket", 0.35), ("rack", 0.15), ("towel_stand", 0.15)):
        add(room, kind, 0.0, probability)
    if room.plan.area > 7.5:
        add(room, "screen", 0.0, 0.12)
    add(room, "scale", 0.0, 0.25)
    add(room, "plain_wardrobe", 0.4, 0.12)
    windows(room, ("short_curtain", "", ""), 0.0)
    hang_kind(room, "towel_rail", 0.85, 0.85)
    hang_kind(room, "towel_hanger", 1.1, 0.35)
    hang_kind(room, "coat_hooks", 1.2, 0.2)
    hang_kind(room, "round_lamp", 1.75, 0.25)
    add_corner(room, "corner_shelf", 0.12)
    add(room, "slim_plant", 0.0, 0.25)


def _washing(room: Room, item: PlacedFurniture) -> PlacedFurniture | None:
    """Place a shower or a corner tub in a corner, its open sides away from the walls; other tubs at a wall."""
    if item.model.family == "shower" or item.model in models_of("corner_bathtub"):
        return in_corner(room, item, 0.45)
    return against_wall(room, item, 0.45, corners=0.2)


def toilet(room: Room) -> None:
    """Place a toilet, paper and a small basin."""
    closet(room)
    basin(room, "small_basin")
    add(room, "paper_bin", 0.0, 0.3)
    windows(room, ("short_curtain", "", ""), 0.0)
    hang_kind(room, "towel_hanger", 1.1, 0.5)
    hang_kind(room, "picture", 1.35, 0.25)


def closet(room: Room) -> PlacedFurniture | None:
    """Place a toilet with paper and a brush; None if it does not fit."""
    if room.chance(0.06) and (placed := fit(room, "corner_toilet", lambda item: across_corner(room, item))):
        return placed
    placed = fit(room, "plain_toilet", lambda item: against_wall(room, item, 0.4))
    if placed is None:
        return None
    for side, kind in zip(room.rng.permutation([-1, 1]).tolist(), ("plunger", "paper_stand"), strict=True):
        if room.chance(0.5):
            next_to(room, placed, room.object(kind), side)
    if room.chance(0.6):
        holder = room.object("paper_holder")
        side = float(placed.size[0] / 2 + holder.size[0] / 2 + 0.12) * (1 if room.chance(0.5) else -1)
        above(room, placed, holder, 0.65, side)
    return placed


def basin(room: Room, kind: str) -> None:
    """Place a basin under a mirror, soap on it, and a lamp above."""
    placed = fit(room, kind, lambda item: against_wall(room, item, 0.4))
    if placed is None and kind != "small_basin":
        placed = fit(room, "small_basin", lambda item: against_wall(room, item, 0.35))
    if placed is None:
        return
    above(room, placed, room.object("bath_mirror"), max(1.15, float(placed.size[1]) + 0.03))
    if room.chance(0.4):
        above(room, placed, room.object("wall_lamp"), 2.0)
    some(room, placed, AT_BASIN, 3)
    if room.chance(0.3):
        _mat(room, placed)


def _mat(room: Room, anchor: PlacedFurniture) -> None:
    """Place a mat in front of a tub, a shower or a basin."""
    mat = room.object("mat")
    x, z = anchor.beside(0.0, float(anchor.size[2] + mat.size[2]) / 2 + 0.06)
    place(room, mat.at(x, FLOOR_TOP, z, anchor.quarter))
