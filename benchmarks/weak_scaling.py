"""Measure weak scaling of PPO over the devices of a host, and predict more of them.

    python benchmarks/weak_scaling.py --devices 1 2 --num-envs 2048 --houses 64 --seconds 30
    python benchmarks/weak_scaling.py --predict scaling.jsonl --to 64 --bandwidth 40

Each number of devices has `--num-envs` environments per device. Prints one JSON object per number: environment steps
per second, the times of single updates, the time of one average of all gradients, and the compile time. `--predict`
reads such lines and prints the rates that `predict` expects. docs/devices.md explains the model.
"""

import argparse
import dataclasses
import json
import math
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

POINT_NAV = {"actions": "discrete", "impl": "kinematic", "stop": True, "success_distance": 0.2}
DEVICES_PER_HOST = 8
LATENCY = 30e-6  # [s], of one hop of an average between hosts
NUM_SAMPLES = 200_000  # of the greatest of several normal numbers


def main() -> None:
    """Measure, or predict from the lines of a file."""
    args = parse()
    if args.predict is not None:
        lines = [json.loads(line) for line in args.predict.read_text().splitlines()]
        for num in (2**k for k in range(int(math.log2(args.to)) + 1)):
            print(json.dumps(predict(lines, num, args.bandwidth * 1e9)), flush=True)
        return
    for num in args.devices:
        print(json.dumps(measure(num, args)), flush=True)


def parse() -> argparse.Namespace:
    """Parse the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--devices", type=int, nargs="+", default=[1], help="numbers of devices")
    parser.add_argument("--num-envs", type=int, default=2048, help="environments of each device")
    parser.add_argument("--houses", type=int, default=64)
    parser.add_argument("--dataset", default="procedural:1200")
    parser.add_argument("--sensors", default="depth,goal")
    parser.add_argument("--seconds", type=float, default=30.0, help="of each measurement")
    parser.add_argument("--predict", type=Path, help="file of such lines; nothing is measured")
    parser.add_argument("--to", type=int, default=64, help="largest number of devices to predict")
    parser.add_argument("--bandwidth", type=float, default=40.0, help="between hosts, of each device [GB/s]")
    return parser.parse_args()


def measure(num_devices: int, args: argparse.Namespace) -> dict[str, Any]:
    """Return the rate of updates on some devices, after two of warming up, and what `predict` needs."""
    import jax

    from home_mjx.core.compile_cache import compiler_options
    from home_mjx.env_factory import make
    from home_mjx.training import CPU_CONFIG, PPO, PPOConfig

    sensors = tuple(args.sensors.split(","))
    env = make("PointNav-v0", args.dataset, num_houses=args.houses, split="train", sensors=sensors, **POINT_NAV)
    base = CPU_CONFIG if jax.default_backend() == "cpu" else PPOConfig()
    config = dataclasses.replace(base, num_envs=args.num_envs * num_devices, stagger=True)
    ppo = PPO(env.core, config, jax.devices()[:num_devices])
    params = ppo.sharding.put_params(env.params)
    begun = time.perf_counter()
    reset, update = (program.compile(compiler_options()) for program in ppo.lower(params))
    compiled = time.perf_counter() - begun
    state = ppo.init(params, jax.random.key(0), reset)
    times: list[float] = []
    while sum(times[2:]) < args.seconds:
        begun = time.perf_counter()
        state, metrics = update(params, state)
        jax.block_until_ready(metrics)
        times.append(time.perf_counter() - begun)
    times = times[2:]
    return {
        "devices": num_devices,
        "device": jax.devices()[0].device_kind,
        "num_envs": config.num_envs,
        "steps_per_second": config.batch_size / float(np.mean(times)),
        "update_s": float(np.mean(times)),
        "update_s_deviation": float(np.std(times)),
        "averages": config.num_epochs * config.num_minibatches,
        "average_s": time_average(ppo, state.net),
        "gradient_bytes": sum(4 * x.size for x in jax.tree.leaves(state.net)),
        "batch_per_device": config.batch_size // num_devices,
        "compile_s": compiled,
    }


def time_average(ppo: Any, net: Any, repeats: int = 20) -> float:
    """Return the seconds of one average of arrays like the gradients over the devices."""
    import jax

    from home_mjx.sharding import REPLICATED, mean_over_devices

    average = ppo.sharding.map(mean_over_devices, (REPLICATED,), REPLICATED)
    net = jax.block_until_ready(average(net))
    begun = time.perf_counter()
    for _ in range(repeats):
        net = average(net)
    jax.block_until_ready(net)
    return (time.perf_counter() - begun) / repeats


def predict(lines: Sequence[dict[str, Any]], num: int, bandwidth: float) -> dict[str, float]:
    """Return the expected rate and efficiency of `num` devices, from measurements of one device and of more.

    An update takes as long as that of one device, plus the averages of gradients, plus the wait for the slowest device.
    Within a host an average takes as long as measured for the most devices. Between hosts it moves
    2 (h - 1) / h of the gradients' bytes at `bandwidth` [B/s], in 2 (h - 1) hops of `LATENCY`, for h hosts. The wait is
    the expected maximum of `num` normal times, whose deviation explains the measurement of most devices.

    Raises:
        ValueError: No line is of one device.
    """
    one = next((line for line in lines if line["devices"] == 1), None)
    if one is None:
        raise ValueError("a prediction needs a measurement of one device")
    most = max(lines, key=lambda line: line["devices"])
    hosts = -(-num // DEVICES_PER_HOST)
    between = 2 * (hosts - 1) * (one["gradient_bytes"] / hosts / bandwidth + LATENCY)
    average = (most["average_s"] if num > 1 else 0.0) + between
    lost = most["update_s"] - one["update_s"] - most["averages"] * most["average_s"]
    deviation = max(lost, 0.0) / expected_maximum(most["devices"]) if most["devices"] > 1 else 0.0
    update = one["update_s"] + most["averages"] * average + deviation * expected_maximum(num)
    return {
        "devices": num,
        "steps_per_second": num * one["batch_per_device"] / update,
        "efficiency": one["update_s"] / update,
        "averages_s": most["averages"] * average,
        "wait_s": deviation * expected_maximum(num),
    }


def expected_maximum(num: int) -> float:
    """Return the expected greatest of `num` standard normal numbers, by random samples in blocks.

    Example:
        >>> round(expected_maximum(2), 2)
        0.56
    """
    if num == 1:
        return 0.0
    random = np.random.default_rng(0)
    count = max(NUM_SAMPLES // num, 2000)
    return float(np.mean(np.max(random.standard_normal((count, num)), axis=1)))


if __name__ == "__main__":
    main()
