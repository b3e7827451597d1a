"""Measure the cost of rays on a CPU, in the form of `home-mjx bench --json`; cameras and timing are of `gpu_rays.py`.

    python benchmarks/make_bank.py sample.pkl --dataset /path/to/suncg
    python benchmarks/warp_renderer.py sample.pkl --num-envs 64 --out depth.npz > peer.jsonl
    python benchmarks/cpu_rays.py sample.pkl --houses "the sample house" --peer peer.jsonl --peer-depth depth.npz

The peer renders on one core, so ratios are also reported per core. Embree is measured if `embreex` is installed.
"""

import argparse
import os
from pathlib import Path

os.environ.setdefault("JAX_PLATFORMS", "cpu")

import numpy as np
from gpu_rays import Bench, against_peer, images, primary, read_peers
from views import every_object_movable, load_bank
from warp_renderer import matrices, triangles_of

from home_mjx.core.profiling import calls_per_second

SIZE = 64  # [px] width and height


def embree_rate(bank, pos, quat):
    """Measure rays per second of one Embree thread over the first house's triangles, with the same cameras."""
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    geometry = bank.geometry
    placed = zip(geometry.instance_model[0], geometry.instance_pose[0], strict=True)
    parts = [triangles_of(geometry, geometry.model_root[m]) @ p[:, :3].T + p[:, 3] for m, p in placed if m >= 0]
    scene = EmbreeScene()
    TriangleMesh(scene, np.concatenate(parts).astype(np.float32))
    at = (np.arange(SIZE) + 0.5) / SIZE * 2 - 1
    x, y = np.meshgrid(at, -at)
    pixels = np.stack([x, y, -np.ones_like(x)], axis=-1).reshape(-1, 3)
    pixels /= np.linalg.norm(pixels, axis=-1, keepdims=True)
    directions = np.einsum("eij,rj->eri", matrices(quat), pixels).reshape(-1, 3).astype(np.float32)
    origins = np.repeat(pos, SIZE**2, axis=0).astype(np.float32)
    return calls_per_second(lambda: scene.run(origins, directions), seconds=3) * len(origins)


def main():
    """Parse the command line and measure."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("bank", type=Path)
    parser.add_argument("--houses", required=True, help="description of the bank")
    parser.add_argument("--num-envs", type=int, default=64)
    parser.add_argument("--peer", type=Path, help="output of warp_renderer.py for this bank")
    parser.add_argument("--peer-depth", type=Path, help="depth images of warp_renderer.py for this bank")
    args = parser.parse_args()
    peers = read_peers(args.peer, args.num_envs)
    bank = load_bank(args.bank)
    moves = Bench(every_object_movable(bank), f"{args.houses}, every object movable", args.num_envs, peers)
    still = Bench(bank, f"{args.houses}, default movable objects", args.num_envs, peers)
    if args.peer_depth:
        against_peer(moves, SIZE, args.peer_depth)
    peers["embree"] = {
        "peer": "Embree, 1 thread,",
        "kind": "closest hit",
        "frames/s": embree_rate(bank, still.pos, still.quat),
    }
    for bench in (still, moves):
        seconds, compile_seconds = bench.seconds(primary(SIZE))
        rays, note = args.num_envs * SIZE**2 / seconds, f"closest hits of camera rays, {os.cpu_count()} cores"
        bench.emit("primary", rays, "rays/s", note, compile_seconds, "embree")
        bench.frames("depth-ids", primary(SIZE), SIZE, "depth, instance, triangle", "depth")
        kinds = ("rgb", "depth", "instance", "fine")
        bench.frames("fast-depth-ids", images(SIZE, *kinds), SIZE, ", ".join(kinds), "rgb+depth")


if __name__ == "__main__":
    main()
