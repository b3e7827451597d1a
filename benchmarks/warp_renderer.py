"""Peer of `gpu_rays.py` and `cpu_rays.py`: MuJoCo Warp's batch renderer on a bank's first house, same cameras.

`python benchmarks/warp_renderer.py BANK --num-envs 4096 --size 64 --out peer.npz` prints one JSON object per image
kind and writes the depth images. With them `gpu_rays.py` checks that both render the same scene.
"""

import argparse
import functools
import json
import time

import mujoco
import numpy as np
from views import cameras, load_bank

KINDS = {
    "depth": {"render_depth": True},
    "rgb+depth": {"render_rgb": True, "render_depth": True},
    "rgb+depth+shadows": {"render_rgb": True, "render_depth": True, "use_shadows": True},
}


def model_of(bank, house=0):
    """Build a model with every instance as a mesh geom of its own body, a camera, and a light with shadows."""
    geometry, spec = bank.geometry, mujoco.MjSpec()
    for number, model in enumerate(geometry.instance_model[house]):
        if model < 0:
            continue
        pose = geometry.instance_pose[house, number].astype(float)
        corners = triangles_of(geometry, geometry.model_root[model]).reshape(-1, 3) @ pose[:, :3].T
        vertices, index = np.unique(corners.astype(np.float32), axis=0, return_inverse=True)
        faces = index.reshape(-1, 3)
        if np.linalg.det(pose[:, :3]) < 0:
            faces = faces[:, ::-1]
        distinct = (faces != np.roll(faces, 1, axis=1)).all(axis=1)
        mesh = spec.add_mesh(name=f"m{number}", uservert=vertices.ravel(), userface=faces[distinct].ravel())
        mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
        body = spec.worldbody.add_body(pos=pose[:, 3])
        geom = body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=f"m{number}", contype=0, conaffinity=0)
        geom.rgba = [0.7, 0.7, 0.7, 1]
    spec.worldbody.add_camera(fovy=90, pos=[0, 0, 1.5])
    spec.worldbody.add_light(pos=[0, 0, 2.2], castshadow=True, type=mujoco.mjtLightType.mjLIGHT_POINT)
    return spec.compile()


def triangles_of(geometry, node):
    """Return the triangles below a node (n, 3, 3)."""
    found, waiting = [], [node]
    while waiting:
        for code in geometry.node_child[waiting.pop()].tolist():
            if code >= 0:
                waiting.append(code)
            else:
                found.append(geometry.triangle[~code >> 4 : (~code >> 4) + (~code & 15)])
    return np.concatenate(found)


def matrices(quat):
    """Return rotation matrices (n, 3, 3)."""
    flat = np.empty((len(quat), 9))
    for row, q in zip(flat, quat.astype(float), strict=True):
        mujoco.mju_quat2Mat(row, q)
    return flat.reshape(-1, 3, 3)


def measure(model, pos, turn, size, options, repeats=5, calls=4):
    """Measure seconds of refitting and rendering a batch, and of compiling; return them with the context."""
    import mujoco_warp as mjw
    import warp as wp

    wp.config.quiet = True  # standard output is reserved for the records

    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    num_envs = len(pos)
    m, d = mjw.put_model(model), mjw.put_data(model, data, nworld=num_envs)
    mjw.kinematics(m, d)
    mjw.camlight(m, d)
    d.cam_xpos.assign(pos[:, None].astype(np.float32))
    d.cam_xmat.assign(turn[:, None].astype(np.float32))
    start = time.perf_counter()
    off = {"render_rgb": False, "render_depth": False, "render_seg": False}
    context = mjw.create_render_context(model, nworld=num_envs, cam_res=(size, size), **(off | options))

    def frame():
        mjw.refit_bvh(m, d, context)
        mjw.render(m, d, context)

    frame()
    wp.synchronize()
    compile_seconds = time.perf_counter() - start
    again = frame
    if wp.get_device().is_cuda:
        with wp.ScopedCapture() as capture:
            frame()
        again = functools.partial(wp.capture_launch, capture.graph)
    times = []
    for _ in range(repeats + 1):
        start = time.perf_counter()
        for _ in range(calls):
            again()
        wp.synchronize()
        times.append((time.perf_counter() - start) / calls)
    return float(np.median(times[1:])), compile_seconds, context


def main():
    """Parse the command line and measure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("bank")
    parser.add_argument("--num-envs", type=int, default=4096)
    parser.add_argument("--size", type=int, nargs="+", default=[64])
    parser.add_argument("--out", help="file for the depth images of the first size (npz)")
    args = parser.parse_args()
    import mujoco_warp

    bank = load_bank(args.bank)
    _, pos, quat = cameras(bank, args.num_envs)
    model, turn = model_of(bank), matrices(quat)
    for size in args.size:
        for kind, options in KINDS.items():
            seconds, compile_seconds, context = measure(model, pos, turn, size, options)
            record = {"kind": kind, "size": size, "frames/s": args.num_envs / seconds, "num_envs": args.num_envs}
            record |= {"compile_seconds": compile_seconds, "peer": f"MuJoCo Warp {mujoco_warp.__version__}"}
            print(json.dumps(record), flush=True)
            if args.out and size == args.size[0] and kind == "depth":
                depth = context.depth_data.numpy().reshape(args.num_envs, size, size)
                np.savez(args.out, depth=depth[:64])


if __name__ == "__main__":
    main()
