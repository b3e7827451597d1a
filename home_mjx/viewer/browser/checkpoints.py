"""Checkpoints of a training run that the viewer offers, and which of them is newest (host only)."""

from dataclasses import dataclass, field, replace
from pathlib import Path

from home_mjx.errors import MissingFileError

NEWEST = "newest"  # choice that follows a training run
SUFFIX = ".npz"
HINT = "Pass the folder of a `home-mjx train` run, or a folder of such runs."


@dataclass(frozen=True)
class Checkpoints:
    """Checkpoints in the folder of a run, or of several runs, and the chosen one.

    Attributes:
        path: A checkpoint, or a folder; None: there are none.
        name: The chosen one: `NEWEST`, or a path below the folder.
        loaded: File and its time of change when `load_path` was called last, as the only entry.

    Example:
        >>> Checkpoints(Path("runs/PointNav-v0/checkpoint.npz")).name
        'checkpoint.npz'
    """

    path: Path | None
    name: str = ""
    loaded: dict[Path, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.path is not None and not self.name:
            object.__setattr__(self, "name", NEWEST if self.path.is_dir() else self.path.name)

    @property
    def folder(self) -> Path:
        """Folder of the checkpoints."""
        assert self.path is not None
        return self.path if self.path.is_dir() else self.path.parent

    def files(self) -> list[Path]:
        """Return the checkpoints in the folder and in those below it, newest first."""
        found = [*self.folder.glob(f"*{SUFFIX}"), *self.folder.glob(f"*/*{SUFFIX}")]
        times = {path: time for path in found if (time := _time_of_change(path)) >= 0}
        return sorted(times, key=lambda path: (-times[path], path))

    def names(self) -> tuple[str, ...]:
        """Return the choices: `NEWEST`, then the files, newest first."""
        return (NEWEST, *(str(path.relative_to(self.folder)) for path in self.files()))

    def choose(self, name: str) -> "Checkpoints":
        """Return the same checkpoints with another choice."""
        return replace(self, name=name, loaded={})

    def load_path(self) -> Path:
        """Return the chosen file, and store its time of change.

        Raises:
            MissingFileError: The folder has no checkpoint.
        """
        path = self._chosen()
        if path is None:
            raise MissingFileError("the folder has no checkpoint", file=self.folder, hint=HINT)
        self.loaded.clear()
        self.loaded[path] = _time_of_change(path)
        return path

    def has_changed(self) -> bool:
        """Return whether the chosen file is another one, or newer, than at the last `load_path`."""
        path = self._chosen()
        return path is not None and self.loaded != {path: _time_of_change(path)}

    def describe(self) -> str:
        """Return the loaded file's name below the folder; "" before the first `load_path`."""
        return ", ".join(str(path.relative_to(self.folder)) for path in self.loaded)

    def _chosen(self) -> Path | None:
        """Return the chosen file; None if there is none."""
        return next(iter(self.files()), None) if self.name == NEWEST else self.folder / self.name


def _time_of_change(path: Path) -> int:
    """Return when a file was changed last [ns]; -1 if it is gone, such as a temporary one."""
    try:
        return path.stat().st_mtime_ns
    except OSError:
        return -1
