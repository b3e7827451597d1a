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
    TOGGLE,
    ArraySpec,
    DiscreteActions,
)
from home_mjx.tasks.base.state import World
from home_mjx.tasks.env.checks import check_choice, clip_action, validate_choice
from home_mjx.tasks.language.vocabulary import tokenize
from home_mjx.tasks.variation.noise import add_move_noise
from home_mjx.tasks.variation.sample import MOVE_NOISE

# Element of a continuous action that each discrete action sets, and its sign; `stop` sets none.
CONTINUOUS_ELEMENTS = {
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
    TOGGLE: (TOGGLE, 1),
}
SPEECH_PREFIXES = ("say", "answer")  # prefixes of actions that speak, before the colon
NO_TOKEN = -1  # token of an agent that says nothing
PITCH_TOLERANCE = 1e-4  # [rad], maximum overshoot of `max_pitch` by a discrete look


class DecodedActions(Pytree):
    """Decoded actions of A agents for one step."""

    drive: Float[Array, "a 3"]  # forward, left, turn left: fractions of the maximum rates
    look: Float[Array, " a"]  # [rad], up
    hands: Float[Array, "a n"]  # elements of `hand_actions.decode_hand_commands`, then `toggle`, as far as there are
    stopped: Bool[Array, " a"]
    spoken_token: Int[Array, " a"]  # token; -1 none
    is_invalid: Bool[Array, ""]  # an action element was clipped or NaN, or is not a discrete action
    action: Float[Array, "a names"]  # the action as decoded: numbers, or one-hot for discrete moves


def action_names(config: EnvConfig) -> tuple[str, ...]:
    """Return the names of the elements of a continuous action, or of the discrete actions.

    Example:
        >>> action_names(EnvConfig(actions="discrete"))
        ('stop', 'move_forward', 'turn_left', 'turn_right', 'look_up', 'look_down')
    """
    return config.action_names


def action_spec(config: EnvConfig) -> ArraySpec:
    """Return the spec of actions of all agents: one number per name, or the index of a discrete action.

    A single agent has no agent axis.
    """
    names = action_names(config)
    text = ", ".join(names)
    if config.discrete is None:
        return ArraySpec((len(names),), "float32", -1.0, 1.0, text).for_agents(config.num_agents)
    return ArraySpec((), "int32", 0, len(names) - 1, text).for_agents(config.num_agents)


def decode_actions(config: EnvConfig, action: Any, stopped: Any, num_commanded: int | None = None) -> DecodedActions:
    """Return the moves of all agents for an action; with continuous actions nobody stops or speaks.

    Args:
        config: Options.
        action: As `action_spec` describes.
        stopped: (a,) bool, agents that have stopped before and stay idle; continuous actions ignore it.
        num_commanded: Number of agents in `action`, the first ones; the others are idle. None: all, by a task.

    Raises:
        ConfigError: The action has another shape or type.
        OutOfRangeError: A caller's discrete action does not exist; only outside `jit`, which cannot raise.
    """
    names, told = action_names(config), num_commanded or config.num_agents
    if config.discrete is None:
        numbers, unusable = clip_action(action, told, len(names))
        numbers = _pad_agents(config, numbers, 0)
        stop, said = jnp.zeros(config.num_agents, bool), jnp.full(config.num_agents, NO_TOKEN, jnp.int32)
        look, understood = numbers[:, 3] * jnp.float32(config.max_pitch_rate * config.timing.ctrl_dt), numbers
    else:
        if num_commanded is not None:
            check_choice(action, names)
        chosen, unusable = validate_choice(action, told, len(names))
        chosen = _pad_agents(config, chosen, len(names))
        stop = stopped | (chosen == names.index("stop"))
        table = jnp.asarray(_move_table(config, config.discrete))
        chosen = jnp.where(stop, names.index("stop"), chosen)
        numbers, understood = jax.vmap(lambda rows, i: rows[i])(table, chosen), jax.nn.one_hot(chosen, len(names))
        said = jnp.asarray(spoken_tokens(config))[chosen]
        look = numbers[:, 3]
    return DecodedActions(
        drive=numbers[:, :3],
        look=look,
        hands=numbers[:, len(ACTION_NAMES) :],
        stopped=stop,
        spoken_token=said,
        is_invalid=unusable,
        action=understood,
    )


def _pad_agents(config: EnvConfig, actions: Array, idle: int) -> Array:
    """Return actions of all agents: `actions` for the first ones, `idle` in each element for the others."""
    others = config.num_agents - actions.shape[0]
    if not others:
        return actions
    return jnp.concatenate([actions, jnp.full((others, *actions.shape[1:]), idle, actions.dtype)])


def override_moves(
    config: EnvConfig, moves: DecodedActions, stopped: Any, mask: Bool[Array, " a"], action: Array
) -> DecodedActions:
    """Return `moves`, with those of masked agents decoded from `action` (of all agents); `is_invalid` stays.

    An action of these that does not exist is idle, and raises no error.
    """
    own = decode_actions(config, action, stopped).replace(is_invalid=moves.is_invalid)

    def pick(new: Array, old: Array) -> Array:
        """Return `new` for masked agents, else `old`, along the first axis; of scalars `old`."""
        return jnp.where(mask.reshape(-1, *[1] * (new.ndim - 1)), new, old) if new.ndim else old

    return jax.tree.map(pick, own, moves)


def apply_move_noise(config: EnvConfig, moves: DecodedActions, world: World) -> DecodedActions:
    """Return the moves with actuation noise, as strong as sampled for the episode, added to `drive`; else unchanged."""
    drawn = world.variation
    if drawn is None or drawn.move_noise is None:
        return moves
    rates = [(body.forward_speed, body.strafe_speed, body.turn_rate) for body in config.agents]
    full = jnp.array(rates, jnp.float32) * config.timing.ctrl_dt
    key = drawn.noise_key(world.step, MOVE_NOISE)
    return moves.replace(drive=add_move_noise(drawn.move_noise, key, moves.drive, full))


def spoken_tokens(config: EnvConfig) -> Int[np.ndarray, " moves"]:
    """Return the token that each discrete action speaks, `NO_TOKEN` for moves; the last entry is for invalid actions.

    Raises:
        ConfigError: The language lacks the word, or an action of `speech` has another form.

    Example:
        >>> spoken_tokens(EnvConfig(actions="discrete", speech=("say:the", "answer:a"))).tolist()[6:]
        [1, 2, -1]
    """
    tokens = [NO_TOKEN] * (len(action_names(config)) - len(config.speech))
    for name in config.speech:
        way, _, word = name.partition(":")
        if way not in SPEECH_PREFIXES or not word or len(word.split()) != 1:
            raise ConfigError(f"`speech` has {name!r}", hint="Write `say:` or `answer:` and a word, such as say:yes.")
        tokens += tokenize(word)
    return np.array([*tokens, NO_TOKEN], np.int32)


def _move_table(config: EnvConfig, moves: DiscreteActions) -> Float[np.ndarray, "a moves n"]:
    """Return discrete actions as continuous ones: fractions of maximum rates, looks [rad]; the last row is idle."""
    names, hands = action_names(config), HAND_NAMES if config.hands else ()
    columns = (*ACTION_NAMES, *hands, *((TOGGLE,) if config.can_toggle else ()))
    table = np.zeros((config.num_agents, len(names) + 1, len(columns)), np.float32)
    for agent, body in enumerate(config.agents):
        sizes = {
            "forward": moves.forward_step_size / (body.forward_speed * config.timing.ctrl_dt),
            "turn_left": math.radians(moves.turn_angle) / (body.turn_rate * config.timing.ctrl_dt),
            "look_up": math.radians(moves.tilt_angle or 0),
        }
        for row, name in enumerate(names):
            if name in CONTINUOUS_ELEMENTS:
                column, sign = CONTINUOUS_ELEMENTS[name]
                table[agent, row, columns.index(column)] = sign * sizes.get(column, 1)
    return table


def update_pitch(config: EnvConfig, pitch: Float[Array, " a"], look: Float[Array, " a"]) -> Float[Array, " a"]:
    """Return the pitch after a look [rad], from -`max_pitch` to `max_pitch`: continuous looks are clipped to it.

    A discrete look that leads more than `PITCH_TOLERANCE` beyond it is skipped.
    """
    most, wanted = jnp.float32(config.max_pitch), pitch + look
    if config.discrete is None:
        return jnp.clip(wanted, -most, most)
    return jnp.where(jnp.abs(wanted) > most + PITCH_TOLERANCE, pitch, wanted)
