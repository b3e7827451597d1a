"""Measure the difficulty of each task with random agents, blind agents and experts, in houses that nobody tuned on.

    python benchmarks/baselines.py [--id ID ...] [--episodes 64] [--num-houses 8] [--out FILE]
    python benchmarks/baselines.py --only-docs [--out FILE]

Runs every id of `home_mjx.list_envs()` as registered, and PointNav with Habitat's options. All three agents play the
same rows, in generated houses of the `val` split with seeds from 30,000. Prints one JSON object for each agent and id.
`--only-docs` writes the last line of each agent and id in a file to the tables of docs/baselines.md and docs/tasks/.

Blind agents use contact, the goal's direction if the task observes it, and questions:

- `straight`: moves towards the goal, and stops there;
- `wander`: moves ahead, turns by a random angle after a contact, and says `stopped` once in 100 steps if possible; with
  hands it also tries to pick;
- `stay`: turns on the spot;
- `prior`: gives the most frequent correct answer to the same question, in 32 houses of the `train` split.
"""

import argparse
import dataclasses
import datetime
import json
import pkgutil
import re
import tempfile
import textwrap
import time
from collections import Counter, defaultdict
from collections.abc import Callable
from itertools import count, islice
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.core.compile_cache import use_compile_cache
from home_mjx.core.profiling import device_name
from home_mjx.datasets.splits import split_of
from home_mjx.houses import load_bank
from home_mjx.scene_compile.objects.fronts import ArticulationOptions
from home_mjx.scene_compile.pipeline.compile import CompileOptions
from home_mjx.tasks import add_expert
from home_mjx.tasks.env.actions import spoken_tokens
from home_mjx.training import Policy, evaluate, expert_policy, random_policy, summarize
from home_mjx.training.evaluation import with_episodes
from home_procgen import generate_dataset
from home_procgen.presets import HOME_VARIANT

ROOT = Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs" / "baselines.md"
MADE = re.compile(r"(<!-- made by benchmarks/baselines\.py(?:: (?P<id>[\w-]+))? -->\n).*?(<!-- end -->)", re.DOTALL)
FIRST_SEED = 30_000
CONTACT = 9  # index of the contact flag in `state`
STOPS = 100  # `wander` stops once in this number of steps
TURNS = (3, 15)  # minimum and maximum number of 10 degree turns after a contact
PICKS = 0.25  # share of the steps in which `wander` tries to pick
HABITAT = {"actions": "discrete", "stop": True, "success_distance": 0.2}
AGENTS = ("random", "blind", "expert")
UNITS = {"distance": " m"}

Act = Callable[[Any, dict[str, Any], Any, Any], Any]  # (remaining turns, observations, begins, keys) to actions


@dataclasses.dataclass(frozen=True)
class Case:
    """Row of the table: an id, its blind agent, and the metrics of its task."""

    id: str
    blind: str
    own: tuple[str, ...] = ("distance",)
    paths: bool = True  # whether SPL is meaningful
    options: dict[str, Any] = dataclasses.field(default_factory=dict)
    name: str = ""


CASES = (
    Case("PointNav-v0", "straight"),
    Case("PointNav-v0", "straight", options=HABITAT, name="PointNav-v0 as Habitat has it"),
    Case("RoomNav-v0", "wander"),
    Case("ObjectNav-v0", "wander"),
    Case("InstructionFollowing-v0", "wander"),
    Case("AudioNav-v0", "wander"),
    Case("Exploration-v0", "wander", ("coverage",), paths=False),
    Case("PiedPiper-v0", "stay", ("near",), paths=False),
    Case("HouseQA-v0", "prior", ("answered",)),
    Case("VQA-v0", "prior", ("answered",), paths=False),
    Case("Dialogue-v0", "wander", ("questions", "distance")),
    Case("Communication-v0", "wander"),
    Case("Fetch-v0", "wander", ("return",)),
    Case("Rearrange-v0", "wander", ("return",)),
    Case("Toggle-v0", "wander", ("return",)),
    Case("FetchFromContainer-v0", "wander", ("return",)),
)


def main() -> None:
    """Play and print, or write the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--id", action="append", help="default: every id")
    parser.add_argument("--episodes", type=int, default=64, help="episodes of each agent, at most 128")
    parser.add_argument("--num-houses", type=int, default=8)
    parser.add_argument("--out", type=Path, default=ROOT / "benchmarks" / "results" / "baselines.jsonl")
    parser.add_argument("--only-docs", action="store_true")
    args = parser.parse_args()
    if not args.only_docs:
        use_compile_cache()
        with tempfile.TemporaryDirectory() as root:
            banks: dict[int, HouseBank] = {}
            for case in (case for case in CASES if not args.id or case.id in args.id):
                fronts = home_mjx.registry.find_spec(case.id).options.get("max_fronts", 0)
                if fronts not in banks:
                    banks[fronts] = unseen(Path(root) / str(fronts), "val", args.num_houses, fronts)
                tell(args.out, played(case, banks[fronts], args))
        return
    lines = [json.loads(line) for line in args.out.read_text(encoding="utf-8").splitlines()]
    for page in (PAGE, *sorted(PAGE.with_name("tasks").glob("*.md"))):
        text = page.read_text(encoding="utf-8")
        page.write_text(MADE.sub(lambda found: filled(found, lines), text), encoding="utf-8")


def unseen(root: Path, split: str, num: int, max_fronts: int = 0) -> HouseBank:
    """Return a bank of generated houses of a split, with seeds that nobody tuned on."""
    seeds = islice((seed for seed in count(FIRST_SEED) if split_of(HOME_VARIANT.house_id(seed)) == split), num)
    options = CompileOptions(articulation=ArticulationOptions(max_fronts))
    return load_bank(root, ids=generate_dataset(root, list(seeds)), options=options)


def played(case: Case, bank: HouseBank, args: argparse.Namespace) -> list[dict[str, Any]]:
    """Return the results of each agent; all play the same rows."""
    begun, num = time.perf_counter(), args.episodes
    env = made(case, bank, -(-num // bank.num_houses))
    tasks = with_episodes(env, num).params.tasks
    if tasks is not None:
        rows = np.random.default_rng(0).permutation(len(tasks))[:num]
        env, num = env.with_tasks(tasks.pick(jnp.asarray(rows, jnp.int32))), len(rows)
    policy = side_by_side(env, blind_of(case.blind, env), num)
    both = evaluate(env, lambda net: policy, None, 2 * num)
    expert = evaluate(add_expert(env), expert_policy, None, num)  # separate, so that others do not wait for it
    parts = [{name: x[part] for name, x in both.items()} for part in (slice(num), slice(num, None))]
    common = {
        "case": "baselines", "id": case.id, "name": case.name or case.id, "houses": bank.num_houses, "episodes": num,
        "first_seed": FIRST_SEED, "options": case.options, "own": case.own, "paths": case.paths,
        "device": device_name(), "date": f"{datetime.datetime.now(datetime.UTC):%Y-%m-%d}",
        "seconds": round(time.perf_counter() - begun, 1),
    }  # fmt: skip
    return [
        common | {"agent": agent, "blind": case.blind, **summarize(part)}
        for agent, part in zip(AGENTS, [*parts, expert], strict=True)
    ]


def made(case: Case, bank: HouseBank, num_tasks: int) -> Any:
    """Make the environment of a case."""
    task = pkgutil.resolve_name(home_mjx.registry.find_spec(case.id).entry_point)
    rows = {"num_tasks": num_tasks} if hasattr(task, "num_tasks") else {}
    senses = {"straight": ("state", "goal"), "prior": ("state", "instruction")}.get(case.blind, ("state",))
    return home_mjx.make(case.id, bank, sensors=senses, **rows, **case.options)


def side_by_side(env: Any, blind: Act, num: int) -> Policy:
    """Combine two agents in one batch: the first `num` environments are random, the others blind."""
    agents, chance = env.num_agents, random_policy(env.core)(None)

    def act(memory: dict[str, Any], obs: dict[str, Any], begins: Any, keys: Any) -> tuple[Any, Any, dict]:
        _, drawn, _ = chance.act((), obs, begins, keys)
        turns, told = blind(memory["turns"], obs, begins, keys)
        who = memory["who"].reshape(-1, *[1] * (drawn.ndim - 1))
        return memory | {"turns": turns}, jnp.where(who == 0, drawn, told.astype(drawn.dtype)), {}

    def memory(rows: int) -> dict[str, Any]:
        assert rows == 2 * num * agents, "all must fit into one batch of `evaluate`"
        return {"who": jnp.arange(rows) // (num * agents), "turns": jnp.zeros(rows, jnp.int32)}

    return Policy(act, initial_memory=memory)


def blind_of(name: str, env: Any) -> Act:
    """Return a blind agent by name."""
    return {"straight": straight, "wander": wander, "stay": stay, "prior": prior}[name](env)


def straight(env: Any) -> Act:
    """Return an agent that turns and moves towards the goal, and stops when it is reached."""
    names, turning = env.core.action_names, np.deg2rad(10) / 2 + 1e-3

    def act(turns: Any, obs: dict[str, Any], begins: Any, keys: Any) -> tuple[Any, Any]:
        distance, error = obs["goal"][:, 0], jnp.arctan2(obs["goal"][:, 2], obs["goal"][:, 1])
        if env.config.discrete is None:
            ahead, turn = obs["goal"][:, 1], jnp.clip(2 * error, -1, 1)
            zero = jnp.zeros_like(turn)
            return turns, jnp.stack([ahead, zero, turn, zero], axis=-1)
        side = jnp.where(error > 0, names.index("turn_left"), names.index("turn_right"))
        go = jnp.where(jnp.abs(error) > turning, side, names.index("move_forward"))
        return turns, jnp.where(distance < env.task.success_distance, names.index("stop"), go)

    return act


def wander(env: Any) -> Act:
    """Return an agent that moves ahead until a contact, then turns left by 30 to 140 degrees."""
    names = env.core.action_names

    def act(turns: Any, obs: dict[str, Any], begins: Any, keys: Any) -> tuple[Any, Any]:
        draw = jax.vmap(lambda key: jax.random.uniform(key, (3,)))(keys)
        new = (TURNS[0] + draw[:, 0] * (TURNS[1] - TURNS[0])).astype(jnp.int32)
        touches = (obs["state"][:, CONTACT] > 0) & (turns == 0)
        left = jnp.where(begins, 0, jnp.where(touches, new, turns))
        action = jnp.where(left > 0, names.index("turn_left"), names.index("move_forward"))
        if "pick" in names:
            action = jnp.where(draw[:, 1] < PICKS, names.index("pick"), action)
        if env.task.requires_stop:
            action = jnp.where(draw[:, 2] < 1 / STOPS, names.index("stop"), action)
        return jnp.maximum(left - 1, 0), action

    return act


def stay(env: Any) -> Act:
    """Return an agent that turns on the spot."""
    turn = env.core.action_names.index("turn_left")
    return lambda turns, obs, begins, keys: (turns, jnp.full(begins.shape, turn))


def prior(env: Any) -> Act:
    """Return an agent that gives the most frequent answer to the same question in training houses, or to any."""
    with tempfile.TemporaryDirectory() as root:
        known = dataclasses.replace(env.task, num_tasks=64).task_bank(unseen(Path(root), "train", 32))
    counts: dict[bytes, Counter[int]] = defaultdict(Counter)
    columns = (np.asarray(known.rows.columns[name]) for name in ("tokens", "answer"))
    for text, answer in zip(*columns, strict=True):
        counts[text.astype(np.int32).tobytes()][int(answer)] += 1
    overall = sum(counts.values(), Counter()).most_common(1)[0][0]
    texts = np.stack([np.frombuffer(text, np.int32) for text in counts])
    said = spoken_tokens(env.config)[:-1]
    number = {int(token): i for i, token in enumerate(said)}
    right = jnp.asarray([number[own.most_common(1)[0][0]] for own in counts.values()])

    def act(turns: Any, obs: dict[str, Any], begins: Any, keys: Any) -> tuple[Any, Any]:
        same = jnp.all(obs["instruction"][:, None] == jnp.asarray(texts)[None], axis=-1)
        return turns, jnp.where(jnp.any(same, axis=1), right[jnp.argmax(same, axis=1)], number[overall])

    return act


def tell(out: Path, lines: list[dict[str, Any]]) -> None:
    """Print the lines and append them to a file."""
    with out.open("a", encoding="utf-8") as file:
        for line in lines:
            text = json.dumps(line)
            print(text, flush=True)
            print(text, file=file)


def filled(found: re.Match[str], lines: list[dict[str, Any]]) -> str:
    """Return a marked part of a page: the table of all ids, or of the named one."""
    kept = [line for line in lines if found["id"] in (None, line["id"])]
    made = table(kept) if kept else f"Not measured yet: `python benchmarks/baselines.py --id {found['id']}`."
    return f"{found[1]}{made}\n{measured(kept)}{found[3]}"


def measured(lines: list[dict[str, Any]]) -> str:
    """Return the date of the last measurement of each task."""
    last = {line["name"]: line.get("date", "") for line in lines}
    days = {day: [name for name in last if last[name] == day] for day in sorted(set(last.values()), reverse=True)}
    if not any(days):
        return ""
    texts = [f"on {day}" if day else "before dates were kept" for day in days]
    if len(days) > 1:
        texts = [f"{text}: {', '.join(names)}" for text, names in zip(texts, days.values(), strict=True)]
    text = f"Measured {'; '.join(texts)}."
    return f"\n{textwrap.fill(text, 120, break_on_hyphens=False)}\n"


def table(lines: list[dict[str, Any]]) -> str:
    """Format the lines as Markdown."""
    found: dict[str, dict[str, Any]] = defaultdict(dict)
    for line in lines:
        found[line["name"]][line["agent"]] = line
    rows = [["Task", "Agent", "Success", "SPL", "Steps", "The task's own", "n"], ["---"] * 7]
    for case in (case.name or case.id for case in CASES):
        for agent in AGENTS if case in found else ():
            line = found[case][agent]
            own = ", ".join(f"{name} {shown(line[name])}{UNITS.get(name, '')}" for name in line["own"])
            name = f"blind: {line['blind']}" if agent == "blind" else agent
            spl = shown(line["spl"]) if line["paths"] and "spl" in line else ""
            steps = line.get("episode_steps") or line["length"]  # older lines of 2026 use the key `length`
            cells = [name, shown(line["success"]), spl, f"{steps['mean']:.0f}", own, str(line["episodes"])]
            rows.append([case.replace(line["id"], f"`{line['id']}`") if agent == AGENTS[0] else "", *cells])
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def shown(figure: dict[str, float]) -> str:
    """Format mean and standard error."""
    return f"{figure['mean']:.2f} ± {figure['stderr']:.2f}"


if __name__ == "__main__":
    main()
