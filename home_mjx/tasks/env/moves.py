"""From actions, continuous or discrete, to what agents do in a step."""

import math
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.core.pytree import Pytree
from home_mjx.errors import ConfigError
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.specs import (
    ACTION_NAMES,
    HAND_NAMES,
    ArraySpec,
    DiscreteActions,
)
from home_mjx.tasks.base.state import World
from home_mjx.tasks.env.usable import usable_action, usable_choice
from home_mjx.tasks.language.vocabulary import tokenize
from home_mjx.tasks.variation.draw import MOVES
from home_mjx.tasks.variation.noise import noisy_moves

# Of each discrete action but `stop`: the number of a continuous one that it sets, and its sign.
SETS = {
    "move_forward": ("forward", 1),
    "turn_left": ("turn_left", 1),
    "turn_right": ("turn_left", -1),
    "look_up": ("look_up", 1),
    "look_down": ("look_up", -1),
    "pick": ("pick", 1),
    "drop": ("pick", -1),
    "throw": ("throw", 1),
    "open": ("turn_door", 1),
    "close": ("turn_door", -1),
}
SPEAKING = ("say", "answer")  # before the colon of an action by which an agent speaks
SILENT = -1  # token of who says nothing
ROUNDING = 1e-4  # [rad], by which a look may end beyond `pitch_max`


class Moves(Pytree):
    """What agents do in a step; A agents."""

    drive: Float[Array, "a 3"]  # forward, left, turn left: parts of the fastest rates
    look: Float[Array, " a"]  # [rad], up
    hands: Float[Array, "a n"]  # see `handling.hand_commands`; n is 0 without hands
    stop: Bool[Array, " a"]
    said: Int[Array, " a"]  # token; -1 none
    unusable: Bool[Array, ""]  # a number of the action was clipped, or is no action
    action: Float[Array, "a names"]  # as it was understood: numbers, or 1 at the chosen move


def action_names(config: EnvConfig) -> tuple[str, ...]:
    """What the numbers of a continuous action mean, or which discrete ones there are.

    Example:
        >>> action_names(EnvConfig(actions="discrete"))
        ('stop', 'move_forward', 'turn_left', 'turn_right', 'look_up', 'look_down')
    """
    return config.action_names


def action_spec(config: EnvConfig) -> ArraySpec:
    """One number per name, or for discrete actions the index of a name; for all agents."""
    names = action_names(config)
    text = ", ".join(names)
    if config.discrete is None:
        return ArraySpec((len(names),), "float32", -1.0, 1.0, text).for_agents(config.num_agents)
    return ArraySpec((), "int32", 0, len(names) - 1, text).for_agents(config.num_agents)


def moves_of(config: EnvConfig, action: Any, stopped: Any, num_told: int | None = None) -> Moves:
    """What an action means for all agents.

    Args:
        config: Options.
        action: As `action_spec` says.
        stopped: (a,) bool, agents that have stopped before: they do nothing. Read after the action has been checked.
        num_told: So many agents the action is of, the first ones; the others do nothing. None: all.

    Raises:
        ConfigError: The action has another shape or type.
    """
    names, told = action_names(config), num_told or config.num_agents
    if config.discrete is None:
        numbers, unusable = usable_action(action, told, len(names))
        numbers = _of_all(config, numbers, 0)
        stop, said = jnp.zeros(config.num_agents, bool), jnp.full(config.num_agents, SILENT, jnp.int32)
        look, understood = numbers[:, 3] * jnp.float32(config.look_rate * config.timing.ctrl_dt), numbers
    else:
        chosen, unusable = usable_choice(action, told, len(names))
        chosen = _of_all(config, chosen, len(names))
        stop = stopped | (chosen == names.index("stop"))
        table = jnp.asarray(_move_table(config, config.discrete))
        chosen = jnp.where(stop, names.index("stop"), chosen)
        numbers, understood = jax.vmap(lambda rows, i: rows[i])(table, chosen), jax.nn.one_hot(chosen, len(names))
        said = jnp.asarray(spoken_tokens(config))[chosen]
        look = numbers[:, 3]
    return Moves(
        drive=numbers[:, :3],
        look=look,
        hands=numbers[:, len(ACTION_NAMES) :],
        stop=stop,
        said=said,
        unusable=unusable,
        action=understood,
    )


def _of_all(config: EnvConfig, told: Array, nothing: int) -> Array:
    """What the first agents are told, and nothing for the others."""
    others = config.num_agents - told.shape[0]
    return jnp.concatenate([told, jnp.full((others, *told.shape[1:]), nothing, told.dtype)]) if others else told


def with_led(config: EnvConfig, moves: Moves, stopped: Any, mask: Bool[Array, " a"], action: Array) -> Moves:
    """The moves, but where a mask holds those that an action of all agents means."""
    own = moves_of(config, action, stopped).replace(unusable=moves.unusable)

    def pick(led: Array, told: Array) -> Array:
        return jnp.where(mask.reshape(-1, *[1] * (led.ndim - 1)), led, told) if led.ndim else told

    return jax.tree.map(pick, own, moves)


def with_noise(config: EnvConfig, moves: Moves, world: World) -> Moves:
    """The moves as agents make them: with the errors that the episode has drawn."""
    drawn = world.drawn
    if drawn is None or drawn.move_noise is None:
        return moves
    rates = [(body.forward_speed, body.strafe_speed, body.turn_rate) for body in config.physics.agents]
    full = jnp.array(rates, jnp.float32) * config.timing.ctrl_dt
    key = drawn.noise_key(world.step, MOVES)
    return moves.replace(drive=noisy_moves(drawn.move_noise, key, moves.drive, full))


def spoken_tokens(config: EnvConfig) -> Int[np.ndarray, " moves"]:
    """Token that each discrete action says, `SILENT` for moves; the last entry is that of a number that is no action.

    Raises:
        ConfigError: The language has no such word, or an action of `speech` has another form.

    Example:
        >>> spoken_tokens(EnvConfig(actions="discrete", speech=("say:the", "answer:a"))).tolist()[6:]
        [1, 2, -1]
    """
    tokens = [SILENT] * (len(action_names(config)) - len(config.speech))
    for name in config.speech:
        way, _, word = name.partition(":")
        if way not in SPEAKING or not word or len(word.split()) != 1:
            raise ConfigError(f"`speech` has {name!r}", hint="Write `say:` or `answer:` and a word, such as say:yes.")
        tokens += tokenize(word)
    return np.array([*tokens, SILENT], np.int32)


def _move_table(config: EnvConfig, moves: DiscreteActions) -> Float[np.ndarray, "a moves n"]:
    """Every agent's discrete actions as continuous ones; looks in radians. The last row does nothing."""
    names, columns = action_names(config), (*ACTION_NAMES, *(HAND_NAMES if config.hands else ()))
    table = np.zeros((config.num_agents, len(names) + 1, len(columns)), np.float32)
    for agent, body in enumerate(config.physics.agents):
        sizes = {
            "forward": moves.forward_step_size / (body.forward_speed * config.timing.ctrl_dt),
            "turn_left": math.radians(moves.turn_angle) / (body.turn_rate * config.timing.ctrl_dt),
            "look_up": math.radians(moves.tilt_angle),
        }
        for row, name in enumerate(names):
            if name in SETS:
                column, sign = SETS[name]
                table[agent, row, columns.index(column)] = sign * sizes.get(column, 1)
    return table


def tilted(config: EnvConfig, pitch: Float[Array, " a"], look: Float[Array, " a"]) -> Float[Array, " a"]:
    """Pitch after a look [rad]; a discrete one that would end beyond `pitch_max` is not done."""
    most, wanted = jnp.float32(config.pitch_max), pitch + look
    if config.discrete is None:
        return jnp.clip(wanted, -most, most)
    return jnp.where(jnp.abs(wanted) > most + ROUNDING, pitch, wanted)
