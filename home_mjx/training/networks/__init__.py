"""Neural networks of agents: encoders by kind of observation, a recurrent core, and heads for actions and value."""

from home_mjx.training.networks.agent import NetworkConfig, RecurrentAgent
from home_mjx.training.networks.distributions import Categorical, Gaussian, make_distribution
from home_mjx.training.networks.text_encoders import TextEncoder, register_text_encoder

__all__ = [
    "Categorical",
    "Gaussian",
    "NetworkConfig",
    "RecurrentAgent",
    "TextEncoder",
    "make_distribution",
    "register_text_encoder",
]
