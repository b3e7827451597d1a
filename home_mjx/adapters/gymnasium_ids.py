"""Registers every environment id with Gymnasium under `home_mjx/`, without importing what makes them."""

import gymnasium

from home_mjx.registry import list_envs


def register_all() -> None:
    """Adds `home_mjx/<id>` for each id that Gymnasium does not have yet."""
    for env_id in list_envs():
        name = f"home_mjx/{env_id}"
        if name not in gymnasium.registry:
            gymnasium.register(
                id=name,
                entry_point="home_mjx.adapters.gymnasium:GymEnv",
                vector_entry_point="home_mjx.adapters.gymnasium:GymVectorEnv",
                kwargs={"env_id": env_id},
            )
