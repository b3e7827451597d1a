"""Things of a house in our frame: our own furniture of their category, front and size, on our own surfaces."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.furniture import Edges, FurniturePiece, FurnitureProvider
from home_mjx.datasets.procthor.assets import AssetTable, ThorAsset
from home_mjx.datasets.procthor.placed import PlacedPiece, Turn, unity_turn
from home_mjx.datasets.procthor.records import ThorObject, ThorRoom
from home_mjx.datasets.procthor.shell import FLOOR, room_polygon
from home_mjx.datasets.procthor.supports import find_support, push_from_walls
from home_mjx.datasets.suncg.fallbacks.models import BoxModels
from home_mjx.datasets.taxonomy import UNKNOWN, vocabulary

UNKNOWN_SIZE = (0.4, 0.4, 0.4)  # [m], of a thing of unknown kind and size
MIN_DOUBLE_WIDTH = 1.2  # [m], of a double bed
MAX_HEIGHT_RATIO = 1.6  # between a typical height and one that follows from the place above the floor
MIN_HANGING_HEIGHT = 0.3  # [m], of the lower edge of what hangs on a wall
HANGING = ("picture_frame", "television", "clock", "curtain", "blinds", "mirror", "switch", "shower_faucet")
UNIT_BOX = np.array([[-0.5, 0.0, -0.5], [0.5, 1.0, 0.5]])  # [m]


class PiecePlacer:
    """Places the things of one house.

    Args:
        rooms: Its rooms.
        assets: Kinds and sizes of models.
        provider: Our furniture.
    """

    def __init__(self, rooms: Sequence[ThorRoom], assets: AssetTable, provider: FurnitureProvider) -> None:
        self.assets, self.provider = assets, provider
        self.polygons = [room_polygon(room) for room in rooms]
        self.numbers = {room.id.removeprefix("room|"): number for number, room in enumerate(rooms)}
        self.placed: list[PlacedPiece] = []

    def place(self, things: Sequence[ThorObject]) -> list[PlacedPiece]:
        """Return the things and what is on them, each after what carries it."""
        for thing in things:
            item = self._on_floor(self._piece(thing))
            self._add(item, np.zeros(2), -1)
        return self.placed

    def _add(self, item: PlacedPiece, shift: Float[np.ndarray, " 2"], parent: int) -> None:
        number = len(self.placed)
        self.placed.append(replace(item, parent=parent))
        moved = item.position[[0, 2]] - _base(item.source, item.turn, item.size)[[0, 2]] if parent < 0 else shift
        for child in item.source.children:
            piece = self._piece(child, True)
            at = piece.position + np.array([moved[0], 0.0, moved[1]])
            piece = replace(piece, position=at, room=item.room if piece.room < 0 else piece.room)
            self._add(find_support(piece, self.placed[number]), moved, number)

    def _piece(self, thing: ThorObject, is_carried: bool = False) -> PlacedPiece:
        asset = self.assets.find(thing.asset, thing.kind)
        turn = unity_turn(thing.rotation)
        fine = vocabulary("ai2thor").get(asset.word, UNKNOWN)
        size = _size(thing, asset, fine, turn)
        if fine == "double_bed" and size[0] < MIN_DOUBLE_WIDTH:
            fine = "single_bed"
        hangs = not is_carried and thing.position[1] - size[1] / 2 > MIN_HANGING_HEIGHT
        shape = "wall" if hangs else _plan(thing.asset)
        piece = self.provider.piece(asset.word, fine, size, thing.asset, shape) or plain_box(size)
        room = self.numbers.get(thing.room.removeprefix("room|"), -1)
        return PlacedPiece(thing, asset, fine, piece, turn, _base(thing, turn, size), size, room)

    def _on_floor(self, item: PlacedPiece) -> PlacedPiece:
        """Return a thing moved off the walls of its room, which have no thickness in ProcTHOR."""
        if item.room < 0:
            return item
        x, z = push_from_walls(item.corners, self.polygons[item.room]).tolist()
        return replace(item, position=item.position + np.array([x, 0.0, z]))


def _base(thing: ThorObject, turn: Turn, size: Edges) -> Float[np.ndarray, " 3"]:
    """Return the middle of the base of a thing in our frame [m]; its position is the middle of its box."""
    x, y, z = thing.position
    return np.array([x, y + FLOOR, -z]) - turn @ np.array([0.0, size[1] / 2, 0.0])


def _size(thing: ThorObject, asset: ThorAsset, fine: str, turn: Turn) -> Edges:
    """Return the size of a thing: that of the database, else what the file tells, else a typical one [m]."""
    if asset.is_known and asset.size is not None:
        return asset.size
    width, height, depth = asset.size or UNKNOWN_SIZE
    if thing.footprint is not None:
        turned = abs(turn[0, 2]) > abs(turn[0, 0])
        width, depth = thing.footprint[::-1] if turned else thing.footprint
    standing = 2 * thing.position[1]
    if fine not in HANGING and height / MAX_HEIGHT_RATIO < standing < height * MAX_HEIGHT_RATIO:
        height = standing
    return max(width, 0.01), max(height, 0.01), max(depth, 0.01)


def _plan(asset: str) -> str:
    """Return the plan of a worktop by its name, such as `L` of `Countertop_L_8x6`; "" for other models."""
    parts = asset.split("_")
    return parts[1] if parts[0].lower().startswith("counter") and len(parts) > 1 and len(parts[1]) == 1 else ""


def plain_box(size: Edges) -> FurniturePiece:
    """Return a box of a size [m], for things of which no model is alike."""
    mesh, _ = BoxModels()(Path("object/plain_box.obj"), UNKNOWN, UNIT_BOX, False)
    return FurniturePiece("plain_box", mesh, size, 0, (), (), "a box")
