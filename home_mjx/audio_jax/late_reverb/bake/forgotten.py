"""What gates forget, of which rays tell that fly on through them; host side.

Each gate knows two rooms of a way at most. So sound that goes to and fro between two rooms, or through three doors,
goes on as all does that goes through its last two: in a house levels of rooms were up to 0.3 dB too high behind one
door, 0.4 behind two, 0.5 behind three. Rays that no gate ends are right about that. Few of them get far, too few to
tell what each cell hears, but enough for all cells of a room and all octaves together.
"""

import numpy as np
from jaxtyping import Float, Int

EDGES = (0, 2, 6, 14, 30, 55, 87)  # bins after a gate between which energies are added up
TOLD = EDGES[-1]  # bins, of which rays tell that no gate ends
USUAL = 0.15  # by how much what gates say is usually wrong: what is told less exactly than that counts less
MOST = 3.0  # by which energies are changed at most
SILENT = 1e-30  # energy below which nothing is told apart


def remembered(
    ours: Float[np.ndarray, "b g n k"], theirs: Float[np.ndarray, "b g n m"], room: Int[np.ndarray, " n"]
) -> Float[np.ndarray, "g n k"]:
    """By how much more each cell hears of each gate than gates say, over time; the same in all cells of a room.

    The mean over octaves, each of which has rays of its own. What they differ by says how exact it is, and in how many
    of them no ray came.

    Args:
        ours: What cells hear in each octave of each gate, as gates say.
        theirs: The same in the first bins as rays say that no gate ends; nothing of a gate from which none flew.
        room: Of each cell.
    """
    member = np.eye(room.max() + 1)[room]
    said, told = (_by_room(x, member) for x in (ours, theirs))
    known = (said > SILENT) & (told.sum(axis=(2, 3), keepdims=True) > 0)
    ratio = np.where(known, told / np.maximum(said, SILENT), 1.0)
    missed = (told <= 0).mean(axis=0) * known.any(axis=0)
    noise = np.maximum(ratio.var(axis=0, ddof=1) / len(ratio), missed**2)
    factor = 1 + USUAL**2 / (USUAL**2 + noise) * (ratio.mean(axis=0) - 1)
    middle = np.convolve(EDGES, [0.5, 0.5], "valid") - 0.5
    factor = np.clip(factor, 1 / MOST, MOST)
    return np.stack([[np.interp(np.arange(ours.shape[3]), middle, one) for one in gate] for gate in factor])[:, room]


def _by_room(heard: Float[np.ndarray, "b g n k"], member: Float[np.ndarray, "n r"]) -> Float[np.ndarray, "b g r e"]:
    """What all cells of each room hear between edges."""
    parts = np.add.reduceat(heard[..., :TOLD], EDGES[:-1], axis=3)
    return np.einsum("bgne,nr->bgre", parts, member)
