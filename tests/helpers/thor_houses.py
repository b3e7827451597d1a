"""Small houses in ProcTHOR's format, made in memory: an L-shaped bedroom, and a kitchen to its east."""

import json
from pathlib import Path

HEIGHT = 2.5
BEDROOM = [(0, 0), (0, 5), (2, 5), (2, 3), (4, 3), (4, 0)]  # (x, z) in Unity's frame, clockwise seen from above
KITCHEN = [(4, 0), (4, 3), (7, 3), (7, 0)]
SIZES = {  # [m], of models
    "Bed": {"Bed_1": (1.4, 0.9, 2.0), "Bed_2": (1.0, 0.8, 2.0)},
    "Book": {"Book_1": (0.2, 0.04, 0.25)},
    "Chair": {"Chair_1": (0.5, 0.9, 0.52), "Chair_2": (0.45, 1.0, 0.5)},
    "CounterTop": {"Countertop_L_6x6": (1.83, 0.94, 1.83)},
    "Dresser": {"Dresser_1": (1.2, 0.8, 0.5)},
    "Painting": {"Wall_Decor_Photo_1": (0.6, 0.4, 0.03)},
}


def xyz(x: float, y: float, z: float) -> dict:
    return {"x": x, "y": y, "z": z}


def wall(room: str, start: tuple, end: tuple, **fields) -> dict:
    name = f"wall|{room}|{start[0]:.2f}|{start[1]:.2f}|{end[0]:.2f}|{end[1]:.2f}"
    corners = [xyz(p[0], y, p[1]) for y in (0, HEIGHT) for p in (start, end)]
    material = {"name": "PureWhite", "color": {"r": 0.5, "g": 0.6, "b": 0.7}}
    return {"id": name, "roomId": f"room|{room}", "polygon": corners, "material": material, **fields}


def walls(room: str, corners: list) -> list[dict]:
    return [wall(room, a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]


def thing(asset: str, room: str, position: tuple, yaw: float = 0.0, children: tuple = (), kind: str = "") -> dict:
    kind = kind or next((kind for kind, rows in SIZES.items() if asset in rows), asset)
    return {
        **{"assetId": asset, "id": f"{kind}|{room}|0", "kinematic": True, "children": list(children)},
        **{"position": xyz(*position), "rotation": xyz(0, yaw, 0)},
    }


def small_house() -> dict:
    """A dresser at the west wall that looks east, with a book; a door 0.5 to 1.5 m from the south end of a wall."""
    book = thing("Book_1", "2", (0.3, 0.8 + 0.02, 1.3), 90)
    return {
        "rooms": [
            {
                **{"id": f"room|{number}", "roomType": kind, "floorMaterial": {"name": "OakWoodFloor"}},
                **{"floorPolygon": [xyz(x, 0, z) for x, z in corners], "ceilings": []},
            }
            for number, kind, corners in (("2", "Bedroom", BEDROOM), ("3", "Kitchen", KITCHEN))
        ],
        "walls": walls("2", BEDROOM) + walls("3", KITCHEN),
        "doors": [
            {
                **{"assetId": "Doorway_1", "id": "door|2|3", "openable": True, "openness": 1},
                **{"holePolygon": [xyz(0.5, 0, 0), xyz(1.5, 2.1, 0)], "assetPosition": xyz(1.0, 1.05, 0)},
                **{"room0": "room|2", "room1": "room|3"},
                **{"wall0": "wall|3|4.00|0.00|4.00|3.00", "wall1": "wall|2|4.00|3.00|4.00|0.00"},
            }
        ],
        "windows": [
            {
                **{"assetId": "Window_Hung_36x32", "id": "window|3|0", "room0": "room|3", "room1": "room|3"},
                **{"holePolygon": [xyz(1.0, 0.9, 0), xyz(2.0, 1.8, 0)], "assetPosition": xyz(1.5, 1.35, 0)},
                **{"wall0": "wall|3|7.00|3.00|7.00|0.00", "wall1": ""},
            }
        ],
        "objects": [
            thing("Dresser_1", "2", (0.25, 0.4, 1.0), 90, (book,)),
            thing("Bed_1", "2", (1.0, 0.45, 4.0), 180),
            thing("Bed_2", "2", (3.4, 0.4, 2.0), 270),
            thing("Chair_1", "3", (5.5, 0.45, 1.5), 30),
        ],
        "proceduralParameters": {
            "ceilingMaterial": {"name": "PureWhite"},
            "lights": [
                {"type": "directional", "position": xyz(0, 0, 0), "intensity": 1},
                {"type": "point", "position": xyz(1, 2.3, 1), "intensity": 0.5, "rgb": {"r": 1, "g": 0.8, "b": 0.6}},
                {"type": "point", "position": xyz(5, 2.3, 1), "intensity": 1.0, "rgb": {"r": 1, "g": 1, "b": 1}},
            ],
        },
        "metadata": {"schema": "1.0.0"},
    }


def database() -> dict:
    return {
        kind: [{"assetId": name, "boundingBox": xyz(*size)} for name, size in rows.items()]
        for kind, rows in SIZES.items()
    }


def write_house(folder: Path, house: dict | None = None, name: str = "house.json", sizes: bool = True) -> Path:
    """Write a house, and the database of the models beside it."""
    path = folder / name
    path.write_text(json.dumps(small_house() if house is None else house))
    if sizes:
        (folder / "asset-database.json").write_text(json.dumps(database()))
    return path
