"""Bathrooms and toilets."""

from home_procgen.floor_plan.placed_model import PlacedModel
from home_procgen.floor_plan.walls import FLOOR_TOP
from home_procgen.furnish.space.corner_placement import add_in_corner, place_across_corner, place_in_corner
from home_procgen.furnish.space.floor_placement import (
    add_at_wall,
    place_against_wall,
    place_first_fitting,
    place_next_to,
    place_object,
)
from home_procgen.furnish.space.room_space import RoomSpace
from home_procgen.furnish.space.top_placement import place_several_on_top
from home_procgen.furnish.space.wall_placement import furnish_windows, hang_above, hang_kind
from home_procgen.style.object_kinds import list_models

ON_BASIN = (
    *(("soap_dispenser", 0.7), ("soap_dish", 0.4), ("set_toiletries", 0.7), ("small_plant", 0.15)),
    *(("candle", 0.12), ("hair_dryer", 0.15), ("cloth", 0.15)),
)


def furnish_bathroom(room: RoomSpace) -> None:
    """Place a tub or shower, a toilet and a basin if they fit; at random towels, a washing machine, bins and others."""
    kinds = room.rng.permutation(["plain_bathtub", "shower"]).tolist()
    if room.plan.area > 7.5 and room.draw_chance(0.1):
        kinds = ["corner_bathtub", *kinds]
    for kind in kinds:
        if washing := place_first_fitting(room, kind, lambda item: _place_bath(room, item)):
            _place_mat(room, washing)
            break
    place_toilet(room)
    place_basin(room, str(room.rng.choice(["small_basin", "vanity", "vanity"])))
    if room.plan.area > 8.5 and room.draw_chance(0.4):
        place_first_fitting(room, "shower", lambda item: _place_bath(room, item))
    if room.plan.area > 8 and room.draw_chance(0.15):
        add_at_wall(room, "bidet", 0.4)
    if washer := add_at_wall(room, "washer", 0.4, 0.4):
        place_several_on_top(room, washer, (("cloth", 0.5), ("soap_dispenser", 0.3), ("iron", 0.12)), 2)
    add_at_wall(room, "dryer", 0.4, 0.1)
    for kind, probability in (("paper_bin", 0.45), ("floor_basket", 0.35), ("rack", 0.15), ("towel_stand", 0.15)):
        add_at_wall(room, kind, 0.0, probability)
    if room.plan.area > 7.5:
        add_at_wall(room, "screen", 0.0, 0.12)
    add_at_wall(room, "scale", 0.0, 0.25)
    furnish_windows(room, ("short_curtain", "", ""), 0.0)
    hang_kind(room, "towel_rail", 0.85, 0.85)
    hang_kind(room, "towel_hanger", 1.1, 0.35)
    hang_kind(room, "round_lamp", 1.75, 0.25)
    add_in_corner(room, "corner_shelf", 0.12)
    add_at_wall(room, "slim_plant", 0.0, 0.25)


def _place_bath(room: RoomSpace, item: PlacedModel) -> PlacedModel | None:
    """Place a shower or a corner tub in a corner, open sides to the room, other tubs at a wall; None without a fit."""
    if item.model.family == "shower" or item.model in list_models("corner_bathtub"):
        return place_in_corner(room, item, 0.45)
    return place_against_wall(room, item, 0.45, corners=0.2)


def furnish_toilet(room: RoomSpace) -> None:
    """Place a toilet and a small basin if they fit; at random a bin, a towel hanger, a curtain and a picture."""
    place_toilet(room)
    place_basin(room, "small_basin")
    add_at_wall(room, "paper_bin", 0.0, 0.3)
    furnish_windows(room, ("short_curtain", "", ""), 0.0)
    hang_kind(room, "towel_hanger", 1.1, 0.5)
    hang_kind(room, "picture", 1.35, 0.25)


def place_toilet(room: RoomSpace) -> PlacedModel | None:
    """Place a toilet, at random in a corner, or with a plunger and paper beside it; None if it does not fit."""
    if room.draw_chance(0.06) and (
        placed := place_first_fitting(room, "corner_toilet", lambda item: place_across_corner(room, item))
    ):
        return placed
    placed = place_first_fitting(room, "plain_toilet", lambda item: place_against_wall(room, item, 0.4))
    if placed is None:
        return None
    for side, kind in zip(room.rng.permutation([-1, 1]).tolist(), ("plunger", "paper_stand"), strict=True):
        if room.draw_chance(0.5):
            place_next_to(room, placed, room.draw_object(kind), side)
    if room.draw_chance(0.6):
        holder = room.draw_object("paper_holder")
        side = float(placed.size[0] / 2 + holder.size[0] / 2 + 0.12) * (1 if room.draw_chance(0.5) else -1)
        hang_above(room, placed, holder, 0.65, side)
    return placed


def place_basin(room: RoomSpace, kind: str) -> None:
    """Place a basin, or a small one if it does not fit, with a mirror and objects; at random a lamp and a mat."""
    placed = place_first_fitting(room, kind, lambda item: place_against_wall(room, item, 0.4))
    if placed is None and kind != "small_basin":
        placed = place_first_fitting(room, "small_basin", lambda item: place_against_wall(room, item, 0.35))
    if placed is None:
        return
    hang_above(room, placed, room.draw_object("bath_mirror"), max(1.15, float(placed.size[1]) + 0.03))
    if room.draw_chance(0.4):
        hang_above(room, placed, room.draw_object("indoor_wall_lamp"), 2.0)
    place_several_on_top(room, placed, ON_BASIN, 3)
    if room.draw_chance(0.3):
        _place_mat(room, placed)


def _place_mat(room: RoomSpace, anchor: PlacedModel) -> None:
    """Place a mat in front of a tub, a shower or a basin, if it fits."""
    mat = room.draw_object("mat")
    x, z = anchor.local_point(0.0, float(anchor.size[2] + mat.size[2]) / 2 + 0.06)
    place_object(room, mat.moved_to(x, FLOOR_TOP, z, anchor.quarter))
