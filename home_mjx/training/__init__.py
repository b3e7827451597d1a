"""Training on the environments: recurrent PPO in plain JAX. `brax_compat` patches brax 0.14.2 for JAX >= 0.10.

Names are imported on first use, because they need the extra `train` and `brax_compat` does not.
"""

import importlib
from typing import TYPE_CHECKING, Any

from home_mjx.errors import ConfigError, install_hint

if TYPE_CHECKING:
    from home_mjx.training.checkpoint import (
        CHECKPOINT_FILE,
        load_checkpoint,
        load_net,
        load_policy,
        read_config,
        save_checkpoint,
        save_net,
    )
    from home_mjx.training.config import CPU_CONFIG, PPOConfig, RunConfig
    from home_mjx.training.evaluation import evaluate, evaluation_spec, expert_policy, random_policy, summarize
    from home_mjx.training.imitation import AdvisedPPO, BehaviorCloning
    from home_mjx.training.networks import NetworkConfig, RecurrentAgent, TextEncoder, register_text_encoder
    from home_mjx.training.ppo import PPO, TrainState
    from home_mjx.training.rollout import Policy
    from home_mjx.training.run import evaluate_checkpoint, train

__all__ = [
    "CHECKPOINT_FILE",
    "CPU_CONFIG",
    "PPO",
    "AdvisedPPO",
    "BehaviorCloning",
    "NetworkConfig",
    "PPOConfig",
    "Policy",
    "RecurrentAgent",
    "RunConfig",
    "TextEncoder",
    "TrainState",
    "evaluate",
    "evaluate_checkpoint",
    "evaluation_spec",
    "expert_policy",
    "load_checkpoint",
    "load_net",
    "load_policy",
    "random_policy",
    "read_config",
    "register_text_encoder",
    "save_checkpoint",
    "save_net",
    "summarize",
    "train",
]

_MODULES = {
    "checkpoint": (
        "CHECKPOINT_FILE",
        "load_checkpoint",
        "load_net",
        "load_policy",
        "read_config",
        "save_checkpoint",
        "save_net",
    ),
    "imitation": ("AdvisedPPO", "BehaviorCloning"),
    "config": ("CPU_CONFIG", "PPOConfig", "RunConfig"),
    "evaluation": ("evaluate", "expert_policy", "evaluation_spec", "random_policy", "summarize"),
    "networks": ("NetworkConfig", "RecurrentAgent", "TextEncoder", "register_text_encoder"),
    "ppo": ("PPO", "TrainState"),
    "rollout": ("Policy",),
    "run": ("evaluate_checkpoint", "train"),
}


def __getattr__(name: str) -> Any:
    module = next((module for module, names in _MODULES.items() if name in names), None)
    if module is None:
        raise AttributeError(f"module 'home_mjx.training' has no attribute {name!r}")
    try:
        return getattr(importlib.import_module(f"home_mjx.training.{module}"), name)
    except ModuleNotFoundError as error:
        raise ConfigError(f"training needs the package `{error.name}`", hint=install_hint("train")) from error
