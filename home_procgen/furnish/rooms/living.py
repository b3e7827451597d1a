"""Living rooms."""

from collections.abc import Iterator
from itertools import islice

import numpy as np

from home_procgen.floor_plan.placed import PlacedFurniture
from home_procgen.floor_plan.walls import FLOOR_TOP, HALF
from home_procgen.furnish.rooms.dining import dining_set
from home_procgen.furnish.space.corners import across_corner, add_corner, corner_spots
from home_procgen.furnish.space.hung import above, hang_kind, pictures, windows
from home_procgen.furnish.space.occupied import hull
from home_procgen.furnish.space.on_top import on_top, some
from home_procgen.furnish.space.room import Room
from home_procgen.furnish.space.spots import (
    GAP,
    add,
    against_wall,
    ahead,
    along_walls,
    clear_of,
    fit,
    next_to,
    place,
    reach,
    scattered,
    zone_before,
)
from home_procgen.furnish.space.tops import carries, tops_of
from home_procgen.furnish.space.turned import turned

NEAREST, FARTHEST = 2.1, 4.3  # [m], range from the television's wall to the back of a sofa at the opposite wall
AMID = (2.9, 3.2, 2.7, 3.5)  # [m], distances to try for a sofa in the middle of the room
BEFORE = 0.38  # [m], gap between sofa and table
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


def living_room(room: Room) -> None:
    """Place a television, a sofa that faces it and a table; then books, plants, and objects by interest."""
    windows(room, ("long_curtain", "long_curtain", "short_curtain", ""), 0.45)
    if room.chance(0.14):
        fire = add(room, "mantel" if room.chance(0.7) else "stove_fire", 0.7)
        some(room, fire, ON_CHEST, 3)
        if fire and room.chance(0.5):
            add(room, "log_basket")
    sofa, table = (corner_lounge(room) if room.chance(0.3) else None) or lounge(room)
    if sofa is not None and table is not None:
        around(room, sofa, table)
    elif sofa is not None:
        fit(room, "low_tv_stand", lambda item: screened(room, item))
    if room.plan.area > 21:
        dining_set(room, 4)
    extras(room)


def extras(room: Room) -> None:
    """Place shelves, instruments, plants and pictures."""
    for probability in (0.75, 0.4):
        add(room, "bookshelf", 0.5, probability * (1.3 if "books" in room.style.interests else 0.7))
    some(room, add(room, "dresser", 0.5, 0.35), ON_CHEST, 4)
    some(room, add(room, "console", 0.4, 0.2), ON_CHEST, 3)
    if room.likes("music", 0.45, 0.04):
        add(room, str(room.rng.choice(["piano", "keyboard", "guitar", "guitar", "microphone", "drumset"])), 0.6)
    if room.likes("pets", 0.4):
        scattered(room, "pet")
    add(room, "fish_tank", 0.5, 0.12)
    if room.likes("travel", 0.25):
        add(room, str(room.rng.choice(["tripod", "magazine_rack"])))
    if room.likes("children", 0.5):
        for _ in range(1 + int(room.rng.integers(3))):
            scattered(room, "floor_toy")
    add_corner(room, "corner_shelf", 0.15)
    add_corner(room, "armchair", 0.1, across_corner)
    for kind, probability in (("bar_cart", 0.12), ("armchair", 0.12), ("tall_clock", 0.08), ("screen", 0.06)):
        add(room, kind, 0.3, probability)
    some(room, add(room, "open_shelf", 0.3, 0.1), (("stereo_set", 0.9), ("books", 0.5)), 2)
    for kind, probability in (("floor_speaker", 0.25), ("magazine_rack", 0.2), ("standing_cooler", 0.04)):
        add(room, kind, 0.0, probability)
    greenery(room, 0.7, 3)
    hang_kind(room, "wall_clock", 1.65, 0.45)
    hang_kind(room, "wall_cooler", 2.05, 0.2)
    hang_kind(room, "wall_shelf", 1.4, 0.3)
    for _ in range(2):
        hang_kind(room, "wall_lamp", 1.65, 0.25)
    if room.likes("art", 0.5):
        hang_kind(room, "wall_ornament", 1.3)
    pictures(room, 7 if "art" in room.style.interests else 4)


def greenery(room: Room, probability: float, most: int) -> None:
    """Place plants at walls."""
    for _ in range(most):
        if room.chance(probability if "plants" in room.style.interests else 0.5 * probability):
            add(room, str(room.rng.choice(["plant", "slim_plant", "slim_plant", "floor_vase"])))


def lounge(room: Room) -> tuple[PlacedFurniture | None, PlacedFurniture | None]:
    """Place a sofa with a table in front of it, if possible opposite a television; None for parts that do not fit."""
    hung = room.chance(0.3)
    for kind in ("sofa", "two_seater"):
        for stand in _stands(room):
            sofa, table = room.object(kind), room.object("coffee_table")
            for spot in _walls(room, stand)[:14]:
                if group := _group(room, spot, sofa, table, hung):
                    some(room, spot, ON_STAND, 3)
                    return group
    return fit(room, "two_seater", lambda item: against_wall(room, item, 0.5)), None


def corner_lounge(room: Room) -> tuple[PlacedFurniture, PlacedFurniture] | None:
    """Place a corner sofa, a table between its wings, and a television at the opposite wall; None if none fits."""
    sofa, table = room.object("corner_sofa"), room.object("coffee_table")
    hand = -1.0 if sofa.mirrored else 1.0
    for spot in corner_spots(room, sofa):
        placed = sofa.at(*spot)
        x, z = placed.beside(0.36 * hand, 0.36)
        low = table.at(x, FLOOR_TOP, z, placed.quarter)
        if not clear_of(low, (placed,)):
            continue
        for stand in _before(room, placed, hand):
            screen = _screen(room, stand, room.chance(0.3))
            group = [placed, low, stand, *([screen] if screen else [])]
            if screen and clear_of(low, (stand, screen)) and room.put(group, [zone_before(stand, 0.55)], views=True):
                some(room, stand, ON_STAND, 3)
                return placed, low
    return None


def _before(room: Room, sofa: PlacedFurniture, hand: float) -> Iterator[PlacedFurniture]:
    """Generate places for a television stand at the wall that a corner sofa faces, in front of its long seat."""
    for stand in _stands(room):
        for spot in _walls(room, stand):
            away = np.subtract((spot.position[0], spot.position[2]), (sofa.position[0], sofa.position[2]))
            way = np.array(ahead(sofa))
            aside = hand * float(away @ np.array([way[1], -way[0]]))
            if spot.quarter == (sofa.quarter + 2) % 4 and 1.2 < away @ way < 4.5 and abs(aside - 0.3) < 0.6:
                yield spot


def _stands(room: Room) -> Iterator[PlacedFurniture]:
    yield from islice(room.options("low_tv_stand"), 3)


def _walls(room: Room, stand: PlacedFurniture) -> list[PlacedFurniture]:
    """Return places for a stand at the walls in random order, those in corners last."""
    spots, corner = along_walls(room, stand, step=0.4)
    order = np.argsort(room.rng.random(len(spots)) + corner, kind="stable").tolist()
    return [stand.at(*spots[i]) for i in order]


def _group(
    room: Room, stand: PlacedFurniture, sofa: PlacedFurniture, table: PlacedFurniture, hung: bool
) -> tuple[PlacedFurniture, PlacedFurniture] | None:
    """Place a television, a sofa opposite and a table between them; None if they do not fit.

    The sofa is at the opposite wall or in the middle of the room.
    """
    far = reach(room, stand.position[0], stand.position[2], ahead(stand)) - HALF - GAP + float(stand.size[2]) / 2
    backs = [far] if NEAREST < far < FARTHEST else [d for d in AMID if d < far - 0.8]
    screen = _screen(room, stand, hung)
    if screen is None or room.solid.meets(np.concatenate([hull(stand), hull(screen)])):
        return None
    for back in backs:
        for shift in (0.0, 0.3, -0.3):
            spot, low = _opposite(room, stand, sofa, table, back - float(stand.size[2]) / 2, shift)
            if (
                low
                and clear_of(low, (stand, screen))
                and room.put([stand, screen, spot, low], [zone_before(stand, 0.55)], views=True)
            ):
                return spot, low
    return None


def _opposite(
    room: Room, stand: PlacedFurniture, sofa: PlacedFurniture, table: PlacedFurniture, back: float, shift: float
) -> tuple[PlacedFurniture, PlacedFurniture | None]:
    """Return a sofa whose back is `back` metres from a stand, and a table as close to it as its shape allows.

    The table is None if the sofa or every place for the table is blocked.
    """
    x, z = stand.beside(shift, back - float(sofa.size[2]) / 2)
    spot = sofa.at(x, FLOOR_TOP, z, stand.quarter + 2)
    if room.solid.meets(hull(spot)):
        return spot, None
    for gap in np.arange(-1.4, 0.5, 0.1).tolist() if sofa.size[2] > 1.2 else (BEFORE,):
        tx, tz = spot.beside(0.0, float(sofa.size[2] + table.size[2]) / 2 + gap)
        low = table.at(tx, FLOOR_TOP, tz, spot.quarter)
        nearer = table.at(*(tx - 0.3 * ahead(spot)[0], FLOOR_TOP, tz - 0.3 * ahead(spot)[1]), spot.quarter)
        if clear_of(nearer, (spot,)) and clear_of(low, (spot,)):
            return spot, low
    return spot, None


def _screen(room: Room, stand: PlacedFurniture, hung: bool) -> PlacedFurniture | None:
    """Return a television on a stand, or on the wall above it; None if no model fits on the stand."""
    x, z = stand.position[0], stand.position[2]
    if hung:
        screen = room.object("wall_television")
        x, z = stand.beside(0.0, float(screen.size[2] - stand.size[2]) / 2 - GAP + 0.002)
        return screen.at(x, FLOOR_TOP + 1.0, z, stand.quarter)
    for screen in (room.object("flat_screen"), *room.options("television")):
        for top in tops_of(stand.model.id)[:2]:
            spot = screen.at(x, stand.position[1] + top.height, z, stand.quarter)
            if carries(stand, top, spot) and clear_of(spot, (stand,)):
                return spot
    return None


def screened(room: Room, stand: PlacedFurniture) -> PlacedFurniture | None:
    """Place a stand with a television at any wall; None if it does not fit."""

    def companions(spot: PlacedFurniture) -> Iterator[PlacedFurniture]:
        screen = _screen(room, spot, False)
        if screen is not None:
            yield screen

    return against_wall(room, stand, 0.5, companions)


def around(room: Room, sofa: PlacedFurniture, table: PlacedFurniture) -> None:
    """Place a rug, armchairs, a lamp, a side table and a picture around a sofa, and objects on the tables."""
    x, _, z = table.position
    if room.chance(0.8):
        place(room, room.object("large_rug").at(x, FLOOR_TOP, z, sofa.quarter))
    for side in (-1, 1):
        if room.chance(0.55):
            _armchair(room, table, side)
    for side, kind in zip(room.rng.permutation([-1, 1]).tolist(), ("floor_lamp", "side_table"), strict=True):
        placed = next_to(room, sofa, room.object(kind), side) if room.chance(0.75) else None
        if placed and kind == "side_table":
            if room.chance(0.6):
                on_top(room, placed, "bedside_lamp", middle=True)
            some(room, placed, ON_SIDE, 2)
    if room.chance(0.6):
        above(room, sofa, room.object("picture"), 1.25)
    for interest, kind in (("games", "chessboard"), ("travel", "magazine"), ("books", "books"), ("art", "figure")):
        if room.likes(interest, 0.3):
            on_top(room, table, kind)
    some(room, table, ON_TABLE, 1 + int(room.rng.integers(5)))
    if room.chance(0.25):
        scattered(room, "ottoman")
    room.reserve(zone_before(table, 0.35))


def _armchair(room: Room, table: PlacedFurniture, side: int) -> None:
    """Place an armchair beside a table, turned towards it."""
    chair = room.object("armchair")
    for away, front in ((0.35, 0.1), (0.5, 0.3), (0.5, -0.1)):
        x, z = table.beside(side * (float(table.size[0] + chair.size[2]) / 2 + away), front)
        turn = table.quarter * np.pi / 2 - side * (np.pi / 2 - 0.35 + float(room.rng.normal(0, 0.12)))
        if place(room, turned(chair, x, FLOOR_TOP, z, turn)):
            return
