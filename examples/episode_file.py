"""Evaluate two agents on the same episodes: sampled once, saved as JSON lines, loaded, and played by both."""

import tempfile
from pathlib import Path

import numpy as np

import home_mjx
from home_mjx.tasks import add_expert, load_tasks, save_tasks
from home_mjx.training import evaluate, expert_policy, random_policy, summarize

home_mjx.use_compile_cache()
env = home_mjx.make("RoomNav-v0", num_houses=2, split="val", sensors=("state",), impl="kinematic", num_tasks=16)

file = Path(tempfile.mkdtemp(prefix="home_mjx_episodes_")) / "room_nav.jsonl"
tasks = env.params.tasks
save_tasks(file, env.bank, tasks.where(np.asarray(tasks.rows.columns["length"]) > 2))  # only paths longer than 2 m
print(f"{file} contains {len(file.read_text().splitlines())} episodes; the first is")
print(file.read_text().splitlines()[0][:160], "...")

env = env.with_tasks(load_tasks(file, env.bank))
num = len(env.params.tasks)
agents = {
    "expert": evaluate(add_expert(env), expert_policy, num_episodes=num),
    "random": evaluate(env, random_policy(env.core), num_episodes=num),
}
for name, results in agents.items():
    figures = summarize(results)
    success, spl = figures["success"], figures["spl"]
    print(f"{name}: success {success['mean']:.2f} ± {success['stderr']:.2f}, SPL {spl['mean']:.2f}")
