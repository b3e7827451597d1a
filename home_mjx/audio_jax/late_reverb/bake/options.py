"""Options of baking late reverberation, and the numbers of rays that they give."""

from dataclasses import dataclass
from typing import Literal, NamedTuple, get_args

from home_mjx.core.checks import check_known, check_number

Device = Literal["auto", "cpu", "gpu"]  # on which rays are traced

QUALITIES = ("fine", "coarse")
DEVICES = get_args(Device)
CELL_RAYS = 64_000  # rays from all cells together
MIN_CELL_RAYS, MAX_CELL_RAYS = 500, 2400  # minimum and maximum rays per cell
OLD_RAYS, OLDEST_RAYS = 30_000, 12_000  # rays from the states of old and very old paths in all rooms together
MAX_ROOM_RAYS = 8000  # maximum rays from each of them
ENTERING_RATIO, SECOND_RATIO = 2, 1  # rays after one and after two doors re those per cell
UNTERMINATED_RAYS = 400  # rays from each of the first portal states, without termination at others
COARSE_CELL_RATIO = 1.6  # edge length of cells in a coarse bake re a fine one
COARSE_RAY_RATIO = 0.1  # rays in a coarse bake re a fine one


class StageSizes(NamedTuple):
    """Rays per portal state in each stage."""

    oldest: int  # very old paths
    old: int
    entering: int  # after one door
    second: int  # after two doors
    unterminated: int  # from each of the first states, without termination at others; 0 none


@dataclass(frozen=True)
class BakeOptions:
    """Options of baking late reverberation.

    Attributes:
        cell_size: Target edge length of a cell [m].
        rays: Rays per cell, each of which carries all octaves. None: as many as 64,000 rays permit, from 500 to 2,400.
            Rays from portal states scale with this number.
        max_bounces: Maximum reflections of the rays that determine the final decay of rooms.
        seed: Seed of all random numbers of rays.
        quality: "coarse": cells are 1.6 times as large, a tenth of the rays are traced, and portal energies are not
            corrected. Baking then takes a sixth of the time.

    Raises:
        ConfigError: An option is out of range or unknown.
    """

    cell_size: float = 1.0
    rays: int | None = None
    max_bounces: int = 250
    seed: int = 0
    quality: Literal["fine", "coarse"] = "fine"

    def __post_init__(self) -> None:
        check_number("cell_size", self.cell_size, 0.25)
        for name in ("rays", "max_bounces"):
            if getattr(self, name) is not None:
                check_number(name, getattr(self, name), 10, integer=True)
        check_number("seed", self.seed, 0, integer=True)
        check_known("quality", [self.quality], QUALITIES)

    @property
    def edge(self) -> float:
        """Target edge length of a cell at this quality [m]."""
        return self.cell_size * (1.0 if self.quality == "fine" else COARSE_CELL_RATIO)

    def ray_counts(self, cells: int, rooms: int) -> tuple[int, StageSizes]:
        """Return the rays per cell, and per portal state in each stage, for a house of some cells and rooms.

        `OLD_RAYS` and `OLDEST_RAYS` are shared by all rooms, at most `MAX_ROOM_RAYS` each. With other rays per cell
        than by default they change in proportion, and are at least as many. There must be a cell and a room.

        Example:
            >>> tuple(BakeOptions().ray_counts(cells, 5)[0] for cells in (20, 64, 160))
            (2400, 1000, 500)
        """
        fine = self.quality == "fine"
        share, default = 1.0 if fine else COARSE_RAY_RATIO, min(max(CELL_RAYS // cells, MIN_CELL_RAYS), MAX_CELL_RAYS)
        rays = self.rays or round(default * share)
        oldest, old = (
            max(min(total // rooms, MAX_ROOM_RAYS) * rays // default, rays) for total in (OLDEST_RAYS, OLD_RAYS)
        )
        return rays, StageSizes(
            oldest, old, ENTERING_RATIO * rays, SECOND_RATIO * rays, UNTERMINATED_RAYS if fine else 0
        )
