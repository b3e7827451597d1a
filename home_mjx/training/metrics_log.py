"""Records of a training run: lines of JSON, TensorBoard events, and curves."""

import json
import math
import socket
import sys
import time
from collections.abc import Mapping
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

from home_mjx.core.files import convert_write_errors, read_text, write_durably, write_synced
from home_mjx.errors import ConfigError, DatasetError, install_hint
from home_mjx.tasks.env.observers import Observer, RunStart

CURVES = (
    "success",
    "held_out/success",
    "spl",
    "return",
    "episode_steps",
    "distance",
    "steps_per_second",
    "loss/entropy",
    "loss/value",
    "loss/agreement",
)

NUM_SMOOTHING_WINDOWS = 20  # number of windows of the moving average over a curve
FREE_SPACE_HINT = "Free some space, then continue with --resume."

Line = dict[str, Any]


class MetricsLog(Observer):
    """File `metrics.jsonl`, one line of JSON per line of metrics; each is on disk before the next event.

    Args:
        folder: Folder of the file.
        steps: Step count at which a resumed run continues; later lines are dropped.

    Attributes:
        lines: All lines.

    Raises:
        DatasetError: The lines of an earlier run are broken.
        ConfigError: On the first event and later: the file cannot be written, such as on a full disk.
    """

    def __init__(self, folder: Path, steps: int = 0) -> None:
        self.path = folder / "metrics.jsonl"
        self.lines = [line for line in read_lines(self.path) if line["steps"] <= steps]

    def on_run_start(self, start: RunStart) -> None:
        """Write the file anew with `lines`: lines after the checkpoint from which a run continues are dropped.

        Raises `ConfigError` if it cannot be written.
        """
        with write_durably(self.path, "metrics", FREE_SPACE_HINT) as file:
            file.write("".join(f"{json.dumps(line)}\n" for line in self.lines).encode())

    def on_log(self, line: Mapping[str, float]) -> None:
        """Append the line to `lines` and the file, without values that are not finite.

        Raises `ConfigError` if it cannot be written.
        """
        self.lines.append(finite_values(line))
        with convert_write_errors("metrics", self.path, FREE_SPACE_HINT):
            write_synced(self.path, f"{json.dumps(self.lines[-1])}\n".encode(), "ab")


class TensorBoardLog(Observer):
    """Scalars for TensorBoard, written synchronously.

    tensorboardX's `SummaryWriter` writes in a thread; if that dies of a full disk, the run waits for it forever.

    Args:
        folder: Folder of the file; created if necessary.
        steps: Step count at which the file starts; TensorBoard drops later scalars of earlier files.

    Raises:
        ConfigError: tensorboardX is not installed; or, on the first event and later, the file cannot be written.
    """

    def __init__(self, folder: Path, steps: int = 0) -> None:
        # `steps`, because otherwise two files of one second would have the same name.
        name = f"events.out.tfevents.{int(time.time())}.{socket.gethostname()}.{steps}"
        self.path, self.steps = folder / name, steps
        self._proto, self._writer_of = _events_package()
        self._writer: Any = None

    def on_run_start(self, start: RunStart) -> None:
        """Create the file and its folder, and mark the start of a session after `steps`."""
        with self._writing():
            self.path.parent.mkdir(parents=True, exist_ok=True)
            self._writer = self._writer_of(str(self.path))
        self._write(file_version="brain.Event:2")
        begun = self._proto.SessionLog(status=self._proto.SessionLog.START)
        self._write(step=self.steps + 1, session_log=begun)

    def on_log(self, line: Mapping[str, float]) -> None:
        """Add the finite floats of a line at its `steps`; names without a slash get the prefix `episode/`."""
        for name, x in finite_values(line).items():
            if isinstance(x, float):
                tag = name if "/" in name else f"episode/{name}"
                self._write(step=line["steps"], summary={"value": [{"tag": tag, "simple_value": x}]})

    def on_checkpoint(self, path: Path, steps: int) -> None:
        """Flush all scalars to disk; arguments are unused."""
        with self._writing():
            self._writer.flush()

    def close(self) -> None:
        """Close the file, if the run started."""
        if self._writer is not None:
            with self._writing():
                self._writer.close()

    def _write(self, **event: Any) -> None:
        """Write one event with these fields and the current time."""
        with self._writing():
            self._writer.write(self._proto.Event(wall_time=time.time(), **event).SerializeToString())

    def _writing(self) -> AbstractContextManager[None]:
        """Return a context that converts write errors to `ConfigError`."""
        return convert_write_errors("events of TensorBoard", self.path, FREE_SPACE_HINT)


class CurvesPlot(Observer):
    """Image `curves.png` with the metrics of `log` over steps, drawn at each checkpoint."""

    def __init__(self, log: MetricsLog) -> None:
        self.log = log

    def on_checkpoint(self, path: Path, steps: int) -> None:
        """Draw `curves.png` beside `metrics.jsonl` from all lines; arguments are unused. Raises as `draw_curves`."""
        draw_curves(self.log.path.with_name("curves.png"), self.log.lines)


def finite_values(line: Mapping[str, float]) -> Line:
    """Return a copy of a line without floats that are NaN or infinite.

    Example:
        >>> finite_values({"steps": 3, "spl": math.nan})
        {'steps': 3}
    """
    return {name: x for name, x in line.items() if not isinstance(x, float) or math.isfinite(x)}


def read_lines(path: Path) -> list[Line]:
    """Read the lines of a `metrics.jsonl`; empty if it is missing; a last line without newline is skipped.

    Raises:
        DatasetError: The file cannot be read, or a line is not a record of numbers; the error names it.
    """
    if not path.exists():
        return []
    *whole, _ = read_text(path).split("\n")
    return [_parse_line(text, path, number) for number, text in enumerate(whole, 1)]


def _parse_line(text: str, path: Path, number: int) -> Line:
    """Parse line `number`, from 1; raise `DatasetError` unless it has finite numbers by name and a whole `steps`."""
    try:
        line = json.loads(text)
        if isinstance(line, dict) and type(line.get("steps")) is int and all(_is_number(x) for x in line.values()):
            return line
        reason = f"expected names, including `steps`, and finite numbers, got `{text:.40}`"
    except (ValueError, RecursionError) as error:
        reason = str(error)
    message = f"line is not a record of a training run: {reason}"
    hint = "Delete the line or the file; only curves are lost."
    raise DatasetError(message, file=path, element=f"line {number}", hint=hint)


def _is_number(x: Any) -> bool:
    """Return whether `x` is a finite number and no bool."""
    return isinstance(x, int | float) and not isinstance(x, bool) and abs(x) <= sys.float_info.max


def draw_curves(path: Path, lines: list[Line]) -> None:
    """Write a PNG of the metrics of `CURVES` that the lines contain, over steps; no file if they contain none.

    Raises:
        ConfigError: Matplotlib is not installed, or the file cannot be written.
    """
    names = [name for name in CURVES if any(name in line for line in lines)]
    if not names:
        return
    axes = _panels(len(names))
    for axis, name in zip(axes, names, strict=True):
        found = [line for line in lines if name in line]
        steps, values = [line["steps"] for line in found], [line[name] for line in found]
        axis.plot(steps, values, color="C0", linewidth=0.8, alpha=0.35)
        axis.plot(steps, moving_average(values), color="C0", linewidth=1.6)
        axis.set_title(name, fontsize=10, loc="left")
        axis.grid(alpha=0.3)
        if name in ("success", "spl"):
            axis.set_ylim(0, 1)
        axis.set_xlabel("environment steps", fontsize=8)
        axis.tick_params(labelsize=8)
    with write_durably(path, "curves", FREE_SPACE_HINT) as file:
        axes[0].figure.savefig(file, format="png", dpi=120)


def moving_average(values: list[float]) -> list[float]:
    """Average each value with those before it, in windows of ceil(n / `NUM_SMOOTHING_WINDOWS`); shorter at the start.

    Without values the result is empty.

    Example:
        >>> moving_average([1.0, 3.0] * 20)[:2]
        [1.0, 2.0]
    """
    size = math.ceil(len(values) / NUM_SMOOTHING_WINDOWS)
    windows = (values[max(0, i + 1 - size) : i + 1] for i in range(len(values)))
    return [sum(window) / len(window) for window in windows]


def _panels(num: int) -> list[Any]:
    """Return `num` axes of a new figure, up to 4 in a row; `ConfigError` if Matplotlib is not installed.

    It is not made by pyplot, which keeps figures and needs a display.
    """
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


def _events_package() -> tuple[Any, Any]:
    """Return the event module and writer class of tensorboardX; raise `ConfigError` if it is not installed."""
    try:
        from tensorboardX.proto import event_pb2
        from tensorboardX.record_writer import RecordWriter
    except ModuleNotFoundError as error:
        raise ConfigError("training needs the package `tensorboardX`", hint=install_hint("train")) from error
    return event_pb2, RecordWriter
