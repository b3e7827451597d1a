"""Loss and exchange of energy of coupled rooms, estimated from ray sums."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int


class RoomExchange(NamedTuple):
    """Loss and exchange of rooms per octave."""

    loss: Float[np.ndarray, "r bands"]  # [1/m], share of energy absorbed per metre
    opening: Float[np.ndarray, "r r bands"]  # [m²], exchange area of open portals
    wall: Float[np.ndarray, "r r bands"]  # [m²], exchange area of transmitting walls


def estimate_exchange(
    volume: Float[np.ndarray, " r"],
    path_length: Float[np.ndarray, "bands r"],
    absorbed: Float[np.ndarray, "bands r"],
    exchanged: Float[np.ndarray, "bands r r"],
    transmitted: Float[np.ndarray, "bands r r"],
    joined: Int[np.ndarray, "p 2"],
) -> RoomExchange:
    """Compute losses [1/m] and symmetric exchange areas [m²] of rooms.

    The loss is the absorbed energy over `path_length`. The area is the exchanged energy times volume over
    `path_length` of the room that it leaves, averaged over both directions. Areas of walls are those of transmitted
    energy, and stay with their pair of rooms.

    Volumes are in m³; the next four arguments are fields of `SourceSums`, summed over all sources. `joined` lists pairs
    of rooms with a portal; if there are any, exchange across a third room is assigned to the rooms on the way.
    """
    rate = volume / np.maximum(path_length, 1e-30)  # (bands, r)
    flows = (x * rate[:, :, None] for x in (exchanged, transmitted))
    exchange = [np.moveaxis(0.5 * (flow + np.swapaxes(flow, 1, 2)), 0, -1) for flow in flows]
    return RoomExchange(
        (absorbed / np.maximum(path_length, 1e-30)).T, _route_exchange(exchange[0], joined), exchange[1]
    )


def _route_exchange(
    exchange: Float[np.ndarray, "r r bands"], joined: Int[np.ndarray, "p 2"]
) -> Float[np.ndarray, "r r bands"]:
    """Route exchange of rooms without common portal through the room that connects both best; drop it if none does.

    The best room has a portal to both, and the largest smaller one of its exchanges with them; the first of equals.
    Without any portal, `exchange` itself is returned.
    """
    if not len(joined):
        return exchange
    near = np.zeros(exchange.shape[:2], bool)
    near[tuple(joined.T)] = near[tuple(joined.T[::-1])] = True
    total, out = exchange.sum(axis=-1), np.where(near[..., None], exchange, 0.0)
    for a, b in np.argwhere(np.triu(~near & (total > 0), 1)):
        over = np.where(near[a] & near[b], np.minimum(total[a], total[b]), 0.0)
        if over.max() > 0:
            c = int(np.argmax(over))
            for one, other in ((a, c), (c, a), (b, c), (c, b)):
                out[one, other] += exchange[a, b]
    return out
