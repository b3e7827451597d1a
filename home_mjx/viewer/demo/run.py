"""The demo from houses to files: compile, walk, draw, measure, search, and move all files into place at the end."""

import functools
import json
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from home_mjx.audio_jax.late_reverb.bake.field_cache import COARSE_BAKE
from home_mjx.core import profiling
from home_mjx.core.compile_cache import compiler_options
from home_mjx.core.files import write_all_or_none
from home_mjx.core.paths import dataset_root
from home_mjx.core.progress import silence
from home_mjx.core.workers import worker_threads
from home_mjx.datasets.base import Dataset
from home_mjx.env_factory import make
from home_mjx.errors import ConfigError
from home_mjx.houses.load import house_set, load_bank
from home_mjx.navigation.grid import geodesic_distance
from home_mjx.tasks.base.state import EnvParams, State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.observers import Observer, ObserverGroup, RunStart
from home_mjx.tasks.experts.expert_observation import EXPERT, add_expert
from home_mjx.viewer.demo.drawing import WalkRecord, write_contact_sheet
from home_mjx.viewer.demo.kernels import compile_beside
from home_mjx.viewer.demo.phase_log import PhaseLog
from home_mjx.viewer.demo.search import film_search

HOUSES = "reading the houses"
COMPILE = "compiling the walk and the search (kept for later runs)"
WALK = "walking"
DRAW = "drawing the contact sheet"
SEARCH = "waiting for the search and its film"
MEASURE = "measuring the rate of steps"
PHASES = (HOUSES, COMPILE, WALK, DRAW, SEARCH, MEASURE)
MEASURED_SECONDS = 1.0  # [s] for which steps are repeated to measure their rate
SEARCH_SEED_OFFSET = 6
TEXTURE_SIZE = 256  # [px], for pictures of 480 lines


@dataclass(frozen=True)
class DemoOptions:
    """Options of the demo.

    Attributes:
        out: Folder for the files.
        suncg: Root of a dataset, or its name; None for generated houses.
        num_houses: Houses in the bank.
        num_envs: Environments in the batch that walks, and whose rate is measured.
        num_steps: Steps of the walk.
        num_views: Number of environments that are drawn, the first ones.
        num_films: Number of filmed searches.
        seed: Seed of all random numbers. The default shows stairs and a search of 77 steps.
    """

    out: Path = Path("demo")
    suncg: str | Path | None = None
    num_houses: int = 8
    num_envs: int = 8
    num_steps: int = 150
    num_views: int = 3
    num_films: int = 1
    seed: int = 12

    @property
    def search_seed(self) -> int:
        """Seed of the searches. With the default, the agent passes through four rooms and finds a talking radio."""
        return self.seed + SEARCH_SEED_OFFSET


def run_demo(options: DemoOptions) -> dict[str, Any]:
    """Walk agents through houses, measure speed, film searches, and write all files into `options.out`, or none.

    Returns:
        The content of `report.json`.
    """
    phases = PhaseLog(PHASES, {WALK: options.num_steps})
    with compile_beside(), ObserverGroup([phases]) as group:
        return _run(options, group)


def _run(options: DemoOptions, observer: Observer) -> dict[str, Any]:
    """Run the demo as `run_demo` does, with its phases reported to `observer`."""
    started = time.perf_counter()
    observer.on_run_start(RunStart("demo", None, "steps", options.num_steps))
    observer.on_phase(HOUSES)
    source = options.suncg or dataset_root() or f"procedural:{options.num_houses}"
    houses = house_set(source, num_houses=options.num_houses)
    bank = load_bank(houses, bakes=(COARSE_BAKE,), texture_size=TEXTURE_SIZE)
    env = make("PointNav-v0", bank, episode_length=10**6)
    with write_all_or_none(options.out, "demo") as folder, worker_threads(1) as thread:
        report = _walk_and_search(env, options, folder, thread, observer)
        report["dataset"] = describe_dataset(houses.resolved_dataset)
        report["peak_memory_bytes"] = profiling.peak_memory_bytes()
        report["wall_seconds"] = time.perf_counter() - started
        (folder / "report.json").write_text(json.dumps(report, indent=2) + "\n")
    return report


def _walk_and_search(
    env: Env[HouseholdEnv], options: DemoOptions, folder: Path, thread: ThreadPoolExecutor, observer: Observer
) -> dict[str, Any]:
    """Draw a walk and film searches into a folder, measure the rate of steps, and return the report.

    Searches are compiled and filmed in `thread` beside the walk; the rate is measured when all is done. The thread
    starts when the walk has been traced: two threads that trace may share functions or not, as it happens. Programs
    would differ then, and the compile cache would not find them again.
    """
    observer.on_phase(COMPILE)
    guided = add_expert(env)
    with silence():
        begin, begin_seconds = _compiled_begin(guided, options)
        states = start_batch(guided, begin, options)
        start = time.perf_counter()
        lowered = jax.jit(jax.vmap(guided.core.step, (None, 0, 0))).lower(
            guided.params, states, _no_actions(guided, states)
        )
        search = thread.submit(film_searches, folder, options)
        step, step_seconds = lowered.compile(compiler_options()), time.perf_counter() - start
    observer.on_phase(WALK)
    walk = record_walk(guided, step, states, options, observer)
    observer.on_phase(DRAW)
    with silence():
        write_contact_sheet(env, walk, folder)
    observer.on_phase(SEARCH)
    searches = search.result()
    observer.on_phase(MEASURE)
    rate = measure_rate(guided, states, step)
    return {
        "versions": profiling.versions(),
        "device": profiling.device_name(),
        "num_houses": env.bank.num_houses,
        "num_envs": options.num_envs,
        "compile_seconds": {"begin": begin_seconds, "step": step_seconds},
        "steps_per_second": rate,
        "triangles": int(env.bank.geometry.triangle.shape[0]),
        "bank_bytes": sum(leaf.nbytes for leaf in jax.tree.leaves(env.bank)),
        "search": searches,
    }


def describe_dataset(dataset: Dataset) -> str:
    """Return the name of a dataset; for generated houses also their folder's name, which has the generator's version.

    Example:
        >>> describe_dataset(open_dataset("procedural:8"))  # doctest: +SKIP
        'procedural:8 (generated-v5)'
    """
    return dataset.name if dataset.name == str(dataset.root) else f"{dataset.name} ({dataset.root.name})"


def film_searches(folder: Path, options: DemoOptions) -> list[dict[str, Any]] | str:
    """Film `num_films` searches of the trained agent; return a dictionary each, or the text of a `ConfigError`.

    The folder must exist. Without the extra `train` there is no film.
    """
    try:
        with silence():  # it runs beside the phases that are shown
            return film_search(folder, options.suncg, options.num_films, options.search_seed)
    except ConfigError as error:  # without the extra `train` the demo has no film
        return str(error)


def _compiled_begin(env: Env[HouseholdEnv], options: DemoOptions) -> tuple[Any, float]:
    """Compile the reset of all `num_envs` environments; return the program and its compile time [s].

    It returns no observations, because the step does not read them and rendering is then compiled only once.
    """
    keys = jnp.zeros((options.num_envs, 2), jnp.uint32)
    houses = jnp.zeros(options.num_envs, jnp.int32)
    reset = functools.partial(env.core.reset, observe=False)
    batch = jax.vmap(reset, (None, 0, 0))
    return profiling.compiled(batch, env.params, keys, houses, options=compiler_options())


def _no_actions(env: Env[HouseholdEnv], states: State) -> jax.Array:
    """Return zero actions for as many environments as `states`."""
    return jnp.zeros((states.reward.shape[0], env.action_size), jnp.float32)


def start_batch(env: Env[HouseholdEnv], begin: Any, options: DemoOptions) -> State:
    """Start environments with the compiled reset `begin`, in turn in all houses, most storeys first.

    Goals are the farthest ones. All environments of a house have the radio `source_height` above the house's first
    goal.
    """

    def farthest_goal(params: EnvParams, state: State) -> jax.Array:
        """Return the index of the goal with the longest geodesic distance from the agent."""
        feet = env.core.snapshot(params, state).feet[0]
        return geodesic_distance(params.bank, state.world.house, None, feet).argmax().astype(jnp.int32)

    keys = jax.random.key_data(jax.random.split(jax.random.key(options.seed), options.num_envs))
    storeys = np.isfinite(np.asarray(env.bank.navigation.floor)).sum(axis=1)
    order = np.argsort(-storeys, kind="stable").astype(np.int32)
    houses = jnp.asarray(order[np.arange(options.num_envs) % env.bank.num_houses])
    states = begin(env.params, keys, houses)
    radio = env.bank.navigation.goal[houses, 0].at[:, 2].add(env.config.source_height)
    sounds = states.world.sounds.replace(pos=radio[:, None])
    goal = jax.jit(jax.vmap(farthest_goal, (None, 0)))(env.params, states)
    return states.replace(world=states.world.replace(sounds=sounds), task=states.task.replace(goal=goal))


def record_walk(
    env: Env[HouseholdEnv], step: Any, states: State, options: DemoOptions, observer: Observer
) -> WalkRecord:
    """Walk environments `num_steps` on their experts' actions with the compiled `step`; return the drawn ones' record.

    The first action is zero. Positions are those of the feet after each step, without the start.
    """
    feet = jax.jit(jax.vmap(lambda params, state: env.core.snapshot(params, state).feet[0], (None, 0)))
    drawn = jax.jit(lambda states: jax.tree.map(lambda x: x[: options.num_views], states))
    walk = WalkRecord(np.asarray(states.world.source[: options.num_views]))
    actions, unread = _no_actions(env, states), states.obs
    for _ in range(options.num_steps):
        states = step(env.params, states.replace(obs=unread), actions)
        actions = states.obs[EXPERT]
        views = drawn(states)
        walk.add(views, np.asarray(feet(env.params, views)))
        observer.on_update(1)
    return walk


def measure_rate(env: Env[HouseholdEnv], states: State, step: Any) -> float:
    """Return environment steps/s of the compiled `step`, with all sensors, from `states` on with random actions."""
    actions = profiling.drawn_actions(_no_actions(env, states).shape)
    batches = profiling.steps_per_second(functools.partial(step, env.params), states, actions, MEASURED_SECONDS)
    return states.reward.shape[0] * batches
