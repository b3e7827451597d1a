"""Living rooms."""

from collections.abc import Iterator
from dataclasses import replace
from itertools import islice

import numpy as np

from home_procgen.floor_plan.placed_model import PlacedModel, yaw_to
from home_procgen.floor_plan.walls import FLOOR_TOP, PRISM_THICKNESS
from home_procgen.furnish.rooms.dining import place_dining_set
from home_procgen.furnish.space.collision_boxes import collision_boxes
from home_procgen.furnish.space.corner_placement import add_in_corner, corner_spots, place_across_corner
from home_procgen.furnish.space.floor_placement import (
    WALL_GAP,
    add_at_wall,
    free_distance,
    front_direction,
    front_zone,
    is_clear_of,
    place_against_wall,
    place_first_fitting,
    place_next_to,
    place_object,
    room_wall_spots,
    scatter,
)
from home_procgen.furnish.space.room_space import RoomSpace
from home_procgen.furnish.space.support_surfaces import can_support, find_support_surfaces
from home_procgen.furnish.space.top_placement import place_on_top, place_several_on_top
from home_procgen.furnish.space.wall_placement import (
    ceiling_height,
    furnish_windows,
    hang_above,
    hang_kind,
    hang_pictures,
)
from home_procgen.style.object_kinds import list_models

# [m], range from the television's wall to the back of a sofa at the opposite wall
MIN_SOFA_DISTANCE, MAX_SOFA_DISTANCE = 2.1, 4.3
FREE_SOFA_DISTANCES = (2.9, 3.2, 2.7, 3.5)  # [m], distances to try for a sofa in the middle of the room
SOFA_TABLE_GAP = 0.38  # [m], gap between sofa and table
ON_TABLE = (
    ("magazine", 0.45),
    ("book", 0.4),
    ("books", 0.25),
    ("cup", 0.5),
    ("candle", 0.35),
    ("fruit_bowl", 0.25),
    ("small_plant", 0.3),
    ("table_vase", 0.3),
    ("ornament", 0.25),
    ("glass", 0.25),
    ("ipad", 0.2),
    ("cellphone", 0.2),
    ("chessboard", 0.08),
    ("teapot", 0.12),
    ("plates", 0.12),
    ("bottle", 0.12),
)
ON_MANTEL = (("table_vase", 0.5), ("photo", 0.6), ("figure", 0.5), ("candle", 0.4), ("table_clock", 0.4))
ON_STAND = (
    *(("soundbar", 0.4), ("playstation", 0.15), ("xbox", 0.15), ("small_plant", 0.3), ("photo", 0.3)),
    *(("ornament", 0.2), ("box_speaker", 0.2)),
)
ON_SIDE = (("cup", 0.4), ("book", 0.4), ("cellphone", 0.25), ("photo", 0.4), ("small_plant", 0.3), ("telephone", 0.25))
ON_CHEST = (
    *(("table_vase", 0.5), ("photo", 0.5), ("figure", 0.45), ("candle", 0.3), ("table_clock", 0.3)),
    *(("books", 0.35), ("small_plant", 0.4), ("ornament", 0.35), ("radio", 0.35), ("fishbowl", 0.06)),
    *(("jug", 0.15), ("stereo_set", 0.25), ("bird_cage", 0.04), ("telephone", 0.15), ("table_fan", 0.06)),
)


def furnish_living_room(room: RoomSpace) -> None:
    """Place a sofa and, if they fit, a television opposite and a table; at random a fireplace, books and others."""
    furnish_windows(room, ("long_curtain", "long_curtain", "short_curtain", ""), 0.45)
    if room.draw_chance(0.14):
        fire = add_at_wall(room, "mantel", 0.7) if room.draw_chance(0.7) else _place_stove(room)
        place_several_on_top(room, fire, ON_MANTEL, 3)
        if fire and room.draw_chance(0.5):
            add_at_wall(room, "log_basket")
    sofa, table = (place_corner_lounge(room) if room.draw_chance(0.3) else None) or place_lounge(room)
    if sofa is not None and table is not None:
        furnish_around_sofa(room, sofa, table)
    elif sofa is not None:
        place_first_fitting(room, "low_tv_stand", lambda item: place_television_stand(room, item))
    if room.plan.area > 21:
        place_dining_set(room, 4)
    place_living_extras(room)


def _place_stove(room: RoomSpace) -> PlacedModel | None:
    """Place an iron stove at a wall, its pipe up to the ceiling; None if it does not fit."""
    ceiling = ceiling_height(room)
    stoves = [room.style.make_object(model, room.look) for model in list_models("stove_fire")]
    stove = min(stoves, key=lambda item: abs(float(item.size[1]) - ceiling))
    return place_against_wall(room, replace(stove, scale=(1.0, round(ceiling / float(stove.size[1]), 4), 1.0)), 0.7)


def place_living_extras(room: RoomSpace) -> None:
    """Place shelves, instruments, toys, pets, lamps, plants and pictures, each at random, some by interest."""
    for probability in (0.75, 0.4):
        add_at_wall(room, "bookshelf", 0.5, probability * (1.3 if "books" in room.style.interests else 0.7))
    place_several_on_top(room, add_at_wall(room, "dresser", 0.5, 0.35), ON_CHEST, 4)
    place_several_on_top(room, add_at_wall(room, "console", 0.4, 0.2), ON_CHEST, 3)
    if room.draw_interest("music", 0.45, 0.04):
        add_at_wall(room, str(room.rng.choice(["piano", "keyboard", "guitar", "guitar", "microphone", "drumset"])), 0.6)
    if room.draw_interest("pets", 0.4):
        scatter(room, "pet")
    add_at_wall(room, "fish_tank", 0.5, 0.12)
    if room.draw_interest("travel", 0.25):
        add_at_wall(room, str(room.rng.choice(["tripod", "magazine_rack"])))
    if room.draw_interest("children", 0.5):
        for _ in range(1 + int(room.rng.integers(3))):
            scatter(room, "floor_toy")
    add_in_corner(room, "corner_shelf", 0.15)
    add_in_corner(room, "armchair", 0.1, place_across_corner)
    for kind, probability in (("bar_cart", 0.12), ("armchair", 0.12), ("tall_clock", 0.08), ("screen", 0.06)):
        add_at_wall(room, kind, 0.3, probability)
    place_several_on_top(room, add_at_wall(room, "open_shelf", 0.3, 0.1), (("stereo_set", 0.9), ("books", 0.5)), 2)
    for kind, probability in (("floor_speaker", 0.25), ("magazine_rack", 0.2), ("standing_cooler", 0.04)):
        add_at_wall(room, kind, 0.0, probability)
    place_plants(room, 0.7, 3)
    hang_kind(room, "wall_clock", 1.65, 0.45)
    hang_kind(room, "wall_cooler", 2.05, 0.2)
    hang_kind(room, "wall_shelf", 1.4, 0.3)
    for _ in range(2):
        hang_kind(room, "indoor_wall_lamp", 1.65, 0.25)
    if room.draw_interest("art", 0.5):
        hang_kind(room, "wall_ornament", 1.3)
    hang_pictures(room, 7 if "art" in room.style.interests else 4)


def place_plants(room: RoomSpace, probability: float, max_plants: int) -> None:
    """Place at most `max_plants` plants at walls, each with a probability, halved unless plants are an interest."""
    for _ in range(max_plants):
        if room.draw_chance(probability if "plants" in room.style.interests else 0.5 * probability):
            add_at_wall(room, str(room.rng.choice(["plant", "slim_plant", "slim_plant", "floor_vase"])))


def place_lounge(room: RoomSpace) -> tuple[PlacedModel | None, PlacedModel | None]:
    """Place a sofa with a table in front of it, if possible opposite a television; None for parts that do not fit."""
    hung = room.draw_chance(0.3)
    for kind in ("sofa", "two_seater"):
        for stand in _stand_candidates(room):
            sofa, table = room.draw_object(kind), room.draw_object("coffee_table")
            for spot in _stand_places(room, stand)[:14]:
                if group := _place_seating_group(room, spot, sofa, table, hung):
                    place_several_on_top(room, spot, ON_STAND, 3)
                    return group
    return place_first_fitting(room, "two_seater", lambda item: place_against_wall(room, item, 0.5)), None


def place_corner_lounge(room: RoomSpace) -> tuple[PlacedModel, PlacedModel] | None:
    """Place a corner sofa, a table between its wings, and a television at the opposite wall; None if none fits."""
    sofa, table = room.draw_object("corner_sofa"), room.draw_object("coffee_table")
    hand = -1.0 if sofa.mirrored else 1.0
    for spot in corner_spots(room, sofa):
        placed = sofa.moved_to(*spot)
        x, z = placed.local_point(0.36 * hand, 0.36)
        low = table.moved_to(x, FLOOR_TOP, z, placed.quarter)
        if not is_clear_of(low, (placed,)):
            continue
        for stand in _stands_facing_sofa(room, placed, hand):
            screen = _television_on(room, stand, room.draw_chance(0.3))
            group = [placed, low, stand, *([screen] if screen else [])]
            if (
                screen
                and is_clear_of(low, (stand, screen))
                and room.try_place(group, [front_zone(stand, 0.55)], views=True)
            ):
                place_several_on_top(room, stand, ON_STAND, 3)
                return placed, low
    return None


def _stands_facing_sofa(room: RoomSpace, sofa: PlacedModel, hand: float) -> Iterator[PlacedModel]:
    """Generate places for a television stand at the wall that a corner sofa faces, in front of its long seat."""
    for stand in _stand_candidates(room):
        for spot in _stand_places(room, stand):
            away = np.subtract((spot.position[0], spot.position[2]), (sofa.position[0], sofa.position[2]))
            way = np.array(front_direction(sofa))
            aside = hand * float(away @ np.array([way[1], -way[0]]))
            if spot.quarter == (sofa.quarter + 2) % 4 and 1.2 < away @ way < 4.5 and abs(aside - 0.3) < 0.6:
                yield spot


def _stand_candidates(room: RoomSpace) -> Iterator[PlacedModel]:
    yield from islice(room.object_candidates("low_tv_stand"), 3)


def _stand_places(room: RoomSpace, stand: PlacedModel) -> list[PlacedModel]:
    """Return places for a stand at the walls in random order, those in corners last."""
    spots, corner = room_wall_spots(room, stand, step=0.4)
    order = np.argsort(room.rng.random(len(spots)) + corner, kind="stable").tolist()
    return [stand.moved_to(*spots[i]) for i in order]


def _place_seating_group(
    room: RoomSpace, stand: PlacedModel, sofa: PlacedModel, table: PlacedModel, hung: bool
) -> tuple[PlacedModel, PlacedModel] | None:
    """Place a television, a sofa opposite and a table between them; None if they do not fit.

    The sofa is at the opposite wall or in the middle of the room.
    """
    far = (
        free_distance(room, stand.position[0], stand.position[2], front_direction(stand))
        - PRISM_THICKNESS
        - WALL_GAP
        + float(stand.size[2]) / 2
    )
    backs = [far] if MIN_SOFA_DISTANCE < far < MAX_SOFA_DISTANCE else [d for d in FREE_SOFA_DISTANCES if d < far - 0.8]
    screen = _television_on(room, stand, hung)
    if screen is None or room.solid.overlaps_any(np.concatenate([collision_boxes(stand), collision_boxes(screen)])):
        return None
    for back in backs:
        for shift in (0.0, 0.3, -0.3):
            spot, low = _sofa_opposite(room, stand, sofa, table, back - float(stand.size[2]) / 2, shift)
            if (
                low
                and is_clear_of(low, (stand, screen))
                and room.try_place([stand, screen, spot, low], [front_zone(stand, 0.55)], views=True)
            ):
                return spot, low
    return None


def _sofa_opposite(
    room: RoomSpace, stand: PlacedModel, sofa: PlacedModel, table: PlacedModel, back: float, shift: float
) -> tuple[PlacedModel, PlacedModel | None]:
    """Return a sofa whose back is `back` metres from a stand, and a table as close to it as its shape allows.

    The table is None if the sofa or every place for the table is blocked.
    """
    x, z = stand.local_point(shift, back - float(sofa.size[2]) / 2)
    spot = sofa.moved_to(x, FLOOR_TOP, z, stand.quarter + 2)
    if room.solid.overlaps_any(collision_boxes(spot)):
        return spot, None
    for gap in np.arange(-1.4, 0.5, 0.1).tolist() if sofa.size[2] > 1.2 else (SOFA_TABLE_GAP,):
        tx, tz = spot.local_point(0.0, float(sofa.size[2] + table.size[2]) / 2 + gap)
        low = table.moved_to(tx, FLOOR_TOP, tz, spot.quarter)
        nearer = table.moved_to(
            *(tx - 0.3 * front_direction(spot)[0], FLOOR_TOP, tz - 0.3 * front_direction(spot)[1]), spot.quarter
        )
        if is_clear_of(nearer, (spot,)) and is_clear_of(low, (spot,)):
            return spot, low
    return spot, None


def _television_on(room: RoomSpace, stand: PlacedModel, hung: bool) -> PlacedModel | None:
    """Return a television, not placed yet, on a stand or, if `hung`, on the wall above; None if none fits the stand."""
    x, z = stand.position[0], stand.position[2]
    if hung:
        screen = room.draw_object("wall_television")
        x, z = stand.local_point(0.0, float(screen.size[2] - stand.size[2]) / 2 - WALL_GAP + 0.002)
        return screen.moved_to(x, FLOOR_TOP + 1.0, z, stand.quarter)
    for screen in (room.draw_object("flat_screen"), *room.object_candidates("television")):
        for top in find_support_surfaces(stand.model.id)[:2]:
            spot = screen.moved_to(x, stand.position[1] + top.height, z, stand.quarter)
            if can_support(stand, top, spot) and is_clear_of(spot, (stand,)):
                return spot
    return None


def place_television_stand(room: RoomSpace, stand: PlacedModel) -> PlacedModel | None:
    """Place a stand with a television at any wall; None if it does not fit."""

    def companions(spot: PlacedModel) -> Iterator[PlacedModel]:
        screen = _television_on(room, spot, False)
        if screen is not None:
            yield screen

    return place_against_wall(room, stand, 0.5, companions)


def furnish_around_sofa(room: RoomSpace, sofa: PlacedModel, table: PlacedModel) -> None:
    """Place, each at random, a rug, armchairs, a lamp, a side table and a picture around a sofa, and table objects."""
    x, _, z = table.position
    if room.draw_chance(0.8):
        place_object(room, room.draw_object("large_rug").moved_to(x, FLOOR_TOP, z, sofa.quarter))
    for side in (-1, 1):
        if room.draw_chance(0.55):
            _place_armchair(room, table, side)
    for side, kind in zip(room.rng.permutation([-1, 1]).tolist(), ("floor_lamp", "side_table"), strict=True):
        placed = place_next_to(room, sofa, room.draw_object(kind), side) if room.draw_chance(0.75) else None
        if placed and kind == "side_table":
            if room.draw_chance(0.6):
                place_on_top(room, placed, "bedside_lamp", middle=True)
            place_several_on_top(room, placed, ON_SIDE, 2)
    if room.draw_chance(0.6):
        hang_above(room, sofa, room.draw_object("picture"), 1.25)
    for interest, kind in (("games", "chessboard"), ("travel", "magazine"), ("books", "books"), ("art", "figure")):
        if room.draw_interest(interest, 0.3):
            place_on_top(room, table, kind)
    place_several_on_top(room, table, ON_TABLE, 1 + int(room.rng.integers(5)))
    if room.draw_chance(0.25):
        scatter(room, "ottoman")
    room.reserve(front_zone(table, 0.35))


def _place_armchair(room: RoomSpace, table: PlacedModel, side: int) -> None:
    """Place an armchair on the left (`side` -1) or right (1) of a table, turned towards it, if it fits."""
    chair = room.draw_object("armchair")
    for away, front in ((0.35, 0.1), (0.5, 0.3), (0.5, -0.1)):
        x, z = table.local_point(side * (float(table.size[0] + chair.size[2]) / 2 + away), front)
        turn = table.quarter * np.pi / 2 - side * (np.pi / 2 - 0.35 + float(room.rng.normal(0, 0.12)))
        if place_object(room, yaw_to(chair, x, FLOOR_TOP, z, turn)):
            return
