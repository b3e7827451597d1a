"""Early warnings of a training that goes wrong, read from the lines of its metrics."""

import logging
import math
from collections.abc import Callable, Iterator, Mapping
from statistics import median

import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.tasks.env.observers import Observer

MIN_LINES = 10  # number of lines before values are compared with earlier ones
MIN_ENTROPY_SHARE = 0.02  # minimum entropy as a fraction of the first one
LOW_SUCCESS = 0.3  # with more success a low entropy is no collapse
MAX_VALUE_RATIO = 100.0  # maximum value loss as a multiple of its median so far
MAX_DEAD_SHARE = 0.5  # maximum fraction of dead units
MIN_UNIT_SPREAD = 1e-3  # minimum standard deviation of a unit that is not dead, of values in -1 .. 1

log = logging.getLogger(__name__)


def dead_units(memory: Float[Array, "r m"]) -> Float[Array, ""]:
    """Return the fraction of units of the memory that have almost the same value in all rows.

    Example:
        >>> float(dead_units(jnp.array([[0.0, 1.0], [0.5, 1.0]])))
        0.5
    """
    return jnp.mean((jnp.std(memory, axis=0) < MIN_UNIT_SPREAD).astype(jnp.float32))


class EarlyWarnings(Observer):
    """Logs a warning when a run shows signs of failure; once per sign, and again after it has gone.

    Signs are a loss that is not finite, entropy near 0 without success, a value loss far above its median, and dead
    units of the memory.

    Args:
        warn: Function that is called with each text.

    Example:
        >>> said = []
        >>> warnings = EarlyWarnings(said.append)
        >>> warnings.on_log({"steps": 100, "dead_units": 0.75})
        >>> said
        ['after 100 steps: 75 % of the units of the memory are dead; try a lower learning rate']
    """

    def __init__(self, warn: Callable[[str], object] = log.warning) -> None:
        self.warn = warn
        self.first_entropy: float | None = None
        self.value_losses: list[float] = []
        self.present: set[str] = set()

    def on_log(self, line: Mapping[str, float]) -> None:
        """Warn of each sign in this line that was not in the line before."""
        signs = dict(self._signs(line))
        for name, text in signs.items():
            if name not in self.present:
                self.warn(f"after {line['steps']} steps: {text}")
        self.present = set(signs)

    def _signs(self, line: Mapping[str, float]) -> Iterator[tuple[str, str]]:
        """Yield name and text of each sign of failure; remember the entropy and the value loss of the line."""
        wrong = [name for name, x in line.items() if name.startswith("loss/") and not math.isfinite(x)]
        if wrong:
            yield "finite", f"{', '.join(wrong)} not finite; try a lower learning rate"
        yield from self._entropy_sign(line)
        yield from self._value_sign(line)
        dead = line.get("dead_units", 0.0)
        if dead > MAX_DEAD_SHARE:
            yield "dead", f"{100 * dead:.0f} % of the units of the memory are dead; try a lower learning rate"

    def _entropy_sign(self, line: Mapping[str, float]) -> Iterator[tuple[str, str]]:
        """Yield the sign of a collapsed entropy; that of continuous actions, which may be negative, is not checked."""
        entropy = line.get("loss/entropy", math.nan)
        if not math.isfinite(entropy):
            return
        self.first_entropy = entropy if self.first_entropy is None else self.first_entropy
        low = self.first_entropy > 0 and entropy < MIN_ENTROPY_SHARE * self.first_entropy
        if low and line.get("success", 0.0) < LOW_SUCCESS:
            text = f"entropy has fallen from {self.first_entropy:.3g} to {entropy:.3g} without success"
            yield "entropy", f"{text}; try a higher entropy_cost"

    def _value_sign(self, line: Mapping[str, float]) -> Iterator[tuple[str, str]]:
        """Yield the sign of an exploded value loss, after `MIN_LINES` lines."""
        loss = line.get("loss/value", math.nan)
        if not math.isfinite(loss):
            return
        usual = median(self.value_losses) if len(self.value_losses) >= MIN_LINES else math.inf
        self.value_losses.append(loss)
        if loss > MAX_VALUE_RATIO * usual:
            text = f"the value loss is {loss:.3g}, its median so far {usual:.3g}"
            yield "value", f"{text}; try a lower learning rate or max_grad_norm"
