"""Contents of a bank in terms of its houses, free of indices into the bank."""

import dataclasses

import numpy as np

from home_mjx.bank.bank import HouseBank


def leaves(bank: HouseBank, node: int) -> list[tuple[int, int]]:
    """First primitive and count of every leaf below a node."""
    found = []
    for code in np.asarray(bank.geometry.node_child)[node].tolist():
        if code >= 0:
            found += leaves(bank, code)
        elif ~code & 15:
            found.append((~code >> 4, ~code & 15))
    return found


def triangles_of(bank: HouseBank, model: int) -> np.ndarray:
    rows = [
        i for first, count in leaves(bank, int(bank.geometry.model_root[model])) for i in range(first, first + count)
    ]
    return np.asarray(bank.geometry.triangle)[sorted(rows)]


def world_surfaces(bank: HouseBank, house: int) -> list[tuple]:
    """What a ray could learn of each instance of a house, free of any index into the bank."""
    g, surfaces = bank.geometry, []
    for i in np.flatnonzero(np.asarray(g.instance_model[house]) >= 0):
        model, rows = int(g.instance_model[house, i]), int(g.instance_material[house, i])
        first = leaves(bank, int(g.model_root[model]))
        index = np.concatenate([np.arange(a, a + n) for a, n in sorted(first)])
        slot, part = np.asarray(g.triangle_slot)[index], np.asarray(g.triangle_part)[index]
        semantic = np.asarray(bank.semantics)[part + int(g.instance_semantic[house, i])]
        sound = np.asarray(bank.materials.absorption)[slot + rows]
        color = np.asarray(bank.materials.albedo)[slot + rows]
        surfaces.append((np.asarray(g.instance_pose[house, i]), triangles_of(bank, model), semantic, sound, color))
    return surfaces


def house_navigation(bank: HouseBank, house: int) -> dict:
    """All that the bank says of one house's navigation, free of numbers that run through all houses."""
    n = bank.navigation
    names = {f.name for f in dataclasses.fields(n)} - {"first_cell", "cell", "cell_coords", "field", "room_surface"}
    cell, first, home = np.asarray(n.cell[house]), int(n.first_cell[house]), int(n.num_cells[house])
    count = int((cell >= 0).sum())
    assert sorted(cell[cell >= 0].tolist()) == list(range(first, first + count))
    np.testing.assert_array_equal((cell >= 0) & (cell < first + home), np.asarray(n.region[house]) == 0)
    own = {"cell": np.where(cell >= 0, cell - first, ~(~cell - first))}
    assert (own["cell"] >= ~(count - 1)).all()
    own |= {name: np.asarray(getattr(n, name))[first : first + count] for name in ("cell_coords", "field")}
    surface = np.asarray(n.room_surface[house])
    own["room_surface"] = np.where(surface[..., None] < 0, -1, np.asarray(bank.semantics)[surface])
    return own | {name: np.asarray(getattr(n, name))[house] for name in names}
