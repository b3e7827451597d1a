"""What a training run leaves to look at: lines of JSON, TensorBoard's events, and curves."""

import json
import math
from pathlib import Path
from types import TracebackType
from typing import Any

from home_mjx.errors import ConfigError, install_hint

CURVES = (
    "success",
    "spl",
    "return",
    "length",
    "distance",
    "steps_per_second",
    "loss/entropy",
    "loss/value",
    "loss/agreement",
)

SMOOTH = 20  # points of a curve that are told apart

Line = dict[str, Any]


class Records:
    """The records of one run, added to line by line.

    Args:
        folder: Where `metrics.jsonl`, `tensorboard/` and `curves.png` are.
        steps: Lines after so many steps are dropped: a resumed run goes on from there.

    Example:
        >>> with Records(Path("runs/one")) as records:  # doctest: +SKIP
        ...     records.add({"steps": 2048, "success": 0.5})
    """

    def __init__(self, folder: Path, steps: int = 0) -> None:
        tensorboard = _tensorboard()
        self.path, self.folder = folder / "metrics.jsonl", folder
        self.lines = [line for line in read_lines(self.path) if line["steps"] <= steps]
        self.path.write_text("".join(f"{json.dumps(line)}\n" for line in self.lines), encoding="utf-8")
        # The suffix: two files that are begun within one second would have the same name.
        self._events = tensorboard.SummaryWriter(
            str(folder / "tensorboard"), purge_step=steps + 1, filename_suffix=f".{steps}"
        )

    def __enter__(self) -> "Records":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._events.close()

    def add(self, line: Line) -> None:
        """Writes a line; what is not a number is left out of it."""
        line = {name: x for name, x in line.items() if not isinstance(x, float) or math.isfinite(x)}
        self.lines.append(line)
        with self.path.open("a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")
        for name, x in line.items():
            if isinstance(x, float):
                self._events.add_scalar(name if "/" in name else f"episode/{name}", x, line["steps"])

    def draw(self) -> None:
        """Writes `curves.png`."""
        self._events.flush()
        draw_curves(self.folder / "curves.png", self.lines)


def read_lines(path: Path) -> list[Line]:
    """The lines of a `metrics.jsonl`; one that a killed process left unfinished is left out."""
    if not path.exists():
        return []
    lines = []
    for text in path.read_text(encoding="utf-8").splitlines():
        try:
            lines.append(json.loads(text))
        except ValueError:
            break
    return lines


def draw_curves(path: Path, lines: list[Line]) -> None:
    """Draws the figures of `CURVES` that there are, over steps.

    Raises:
        ConfigError: Matplotlib is not installed.
    """
    names = [name for name in CURVES if any(name in line for line in lines)]
    if not names:
        return
    axes = _panels(len(names))
    for axis, name in zip(axes, names, strict=True):
        found = [line for line in lines if name in line]
        steps, values = [line["steps"] for line in found], [line[name] for line in found]
        axis.plot(steps, values, color="C0", linewidth=0.8, alpha=0.35)
        axis.plot(steps, smoothed(values), color="C0", linewidth=1.6)
        axis.set_title(name, fontsize=10, loc="left")
        axis.grid(alpha=0.3)
        if name in ("success", "spl"):
            axis.set_ylim(0, 1)
        axis.set_xlabel("environment steps", fontsize=8)
        axis.tick_params(labelsize=8)
    axes[0].figure.savefig(path, dpi=120)


def smoothed(values: list[float]) -> list[float]:
    """The mean of each value and those before it, up to the `SMOOTH`-th part of all.

    Example:
        >>> smoothed([1.0, 3.0] * 20)[:2]
        [1.0, 2.0]
    """
    size = math.ceil(len(values) / SMOOTH)
    windows = (values[max(0, i + 1 - size) : i + 1] for i in range(len(values)))
    return [sum(window) / len(window) for window in windows]


def _panels(num: int) -> list[Any]:
    """Axes of a figure; without pyplot, which would keep all figures and ask for a screen."""
    try:
        from matplotlib.figure import Figure
        from matplotlib.ticker import EngFormatter
    except ModuleNotFoundError as error:
        raise ConfigError("curves need the package `matplotlib`", hint=install_hint("train")) from error
    columns = min(num, 4)
    figure = Figure(figsize=(3.2 * columns, 2.4 * -(-num // columns)), layout="constrained")
    axes = [figure.add_subplot(-(-num // columns), columns, i + 1) for i in range(num)]
    for axis in axes:
        axis.xaxis.set_major_formatter(EngFormatter())
    return axes


def _tensorboard() -> Any:
    try:
        import tensorboardX
    except ModuleNotFoundError as error:
        raise ConfigError("training needs the package `tensorboardX`", hint=install_hint("train")) from error
    return tensorboardX
