"""Decoding of actions, continuous or discrete, into the moves of one step."""

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

# Element of a continuous action that each discrete action sets, and its sign; `stop` sets none.
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
SPEAKING = ("say", "answer")  # prefixes of actions that speak, before the colon
SILENT = -1  # token of an agent that says nothing
ROUNDING = 1e-4  # [rad], maximum overshoot of `pitch_max` by a discrete look


class Moves(Pytree):
    """Decoded actions of A agents for one step."""

    drive: Float[Array, "a 3"]  # forward, left, turn left: fractions of the maximum rates
    look: Float[Array, " a"]  # [rad], up
    hands: Float[Array, "a n"]  # see `handling.hand_commands`; n is 0 without hands
    stop: Bool[Array, " a"]
    said: Int[Array, " a"]  # token; -1 none
    unusable: Bool[Array, ""]  # an action element was clipped or NaN, or is not a discrete action
    action: Float[Array, "a names"]  # the action as decoded: numbers, or one-hot for discrete moves


def action_names(config: EnvConfig) -> tuple[str, ...]:
    """Return the names of the elements of a continuous action, or of the discrete actions.

    Example:
        >>> action_names(EnvConfig(actions="discrete"))
        ('stop', 'move_forward', 'turn_left', 'turn_right', 'look_up', 'look_down')
    """
    return config.action_names


def action_spec(config: EnvConfig) -> ArraySpec:
    """Return the spec of actions of all agents: one number per name, or the index of a discrete action."""
    names = action_names(config)
    text = ", ".join(names)
    if config.discrete is None:
        return ArraySpec((len(names),), "float32", -1.0, 1.0, text).for_agents(config.num_agents)
    return ArraySpec((), "int32", 0, len(names) - 1, text).for_agents(config.num_agents)


def moves_of(config: EnvConfig, action: Any, stopped: Any, num_told: int | None = None) -> Moves:
    """Return the moves of all agents for an action.

    Args:
        config: Options.
        action: As `action_spec` describes.
        stopped: (a,) bool, agents that have stopped before and stay idle. Read after the action has been validated.
        num_told: Number of agents in `action`, the first ones; the others are idle. None: all.

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
    """Append idle actions for the agents that `told` does not cover."""
    others = config.num_agents - told.shape[0]
    return jnp.concatenate([told, jnp.full((others, *told.shape[1:]), nothing, told.dtype)]) if others else told


def with_led(config: EnvConfig, moves: Moves, stopped: Any, mask: Bool[Array, " a"], action: Array) -> Moves:
    """Replace the moves of the masked agents by those of `action`, which covers all agents."""
    own = moves_of(config, action, stopped).replace(unusable=moves.unusable)

    def pick(led: Array, told: Array) -> Array:
        return jnp.where(mask.reshape(-1, *[1] * (led.ndim - 1)), led, told) if led.ndim else told

    return jax.tree.map(pick, own, moves)


def with_noise(config: EnvConfig, moves: Moves, world: World) -> Moves:
    """Add actuation noise to the moves, as strong as sampled for the episode."""
    drawn = world.drawn
    if drawn is None or drawn.move_noise is None:
        return moves
    rates = [(body.forward_speed, body.strafe_speed, body.turn_rate) for body in config.physics.agents]
    full = jnp.array(rates, jnp.float32) * config.timing.ctrl_dt
    key = drawn.noise_key(world.step, MOVES)
    return moves.replace(drive=noisy_moves(drawn.move_noise, key, moves.drive, full))


def spoken_tokens(config: EnvConfig) -> Int[np.ndarray, " moves"]:
    """Return the token that each discrete action speaks, `SILENT` for moves; the last entry is for invalid actions.

    Raises:
        ConfigError: The language lacks the word, or an action of `speech` has another form.

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
    """Return every agent's discrete actions as continuous ones, with looks in radians. The last row is idle."""
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
    """Return the pitch after a look [rad]; a discrete look beyond `pitch_max` is skipped, a continuous one clipped."""
    most, wanted = jnp.float32(config.pitch_max), pitch + look
    if config.discrete is None:
        return jnp.clip(wanted, -most, most)
    return jnp.where(jnp.abs(wanted) > most + ROUNDING, pitch, wanted)
