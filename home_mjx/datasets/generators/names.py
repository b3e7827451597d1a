"""Names of generated houses, used instead of a folder: `procedural:16?seed=100&version=2`."""

from dataclasses import dataclass
from pathlib import Path
from urllib.parse import parse_qsl

from home_mjx.core.checks import check_known, check_number
from home_mjx.core.paths import cache_folder
from home_mjx.datasets.generators.generate import check_version, generate_dataset
from home_mjx.datasets.procedural.dataset import VERSION
from home_mjx.datasets.seeds import house_id
from home_mjx.errors import ConfigError

PREFIX = "procedural:"
FORM = "Write `procedural:N` or `procedural:N?seed=S&version=V` with whole numbers."


@dataclass(frozen=True)
class ProceduralHouses:
    """Generated houses of consecutive seeds, stored in the cache folder.

    Attributes:
        count: Number of houses.
        seed: First seed.
        version: Generator version.
    """

    count: int
    seed: int = 0
    version: int = VERSION

    def __post_init__(self) -> None:
        check_number("N", self.count, 1, whole=True)
        check_number("seed", self.seed, 0, whole=True)
        check_version(self.version)

    @classmethod
    def named(cls, text: object) -> "ProceduralHouses | None":
        """Parse a name of generated houses; None if it has another form, such as a folder.

        Args:
            text: Name such as `procedural:16?seed=100&version=2`.

        Raises:
            ConfigError: The name has the prefix, but a wrong form.

        Example:
            >>> ProceduralHouses.named("procedural:16?seed=100")
            ProceduralHouses(count=16, seed=100, version=1)
        """
        if not isinstance(text, str) or not text.startswith(PREFIX):
            return None
        count, _, options = text.removeprefix(PREFIX).partition("?")
        try:
            pairs = dict(parse_qsl(options, keep_blank_values=True, strict_parsing=bool(options)))
            check_known("option of generated houses", pairs, ("seed", "version"))
            return cls(int(count), **{name: int(value) for name, value in pairs.items()})
        except ValueError:
            raise ConfigError(f"`{text}` does not name generated houses", hint=FORM) from None

    @property
    def ids(self) -> tuple[str, ...]:
        """Ids of the houses, in the order of their seeds."""
        return tuple(house_id(seed) for seed in range(self.seed, self.seed + self.count))

    def write(self, progress: bool = False) -> Path:
        """Generate missing houses and return the root of their dataset, which may contain other houses.

        Args:
            progress: Show a progress bar.

        Raises:
            DatasetError: The cache folder cannot be written to.
        """
        root = cache_folder() / f"generated-v{self.version}"
        generate_dataset(root, range(self.seed, self.seed + self.count), progress, self.version)
        return root
