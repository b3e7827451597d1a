"""House in viser's scene: groups of instances per level, poses after each step, and an observer that moves them."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import jax
import numpy as np

from home_mjx.raycast_render.scene.types import DynamicInstances
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.observers import EpisodeStep, Observer, RunStart
from home_mjx.viewer.browser.scene.house_scene import CEILING, MOVING, OUTDOORS, HouseScene, InstanceGroup
from home_mjx.viewer.browser.scene.models import ModelLibrary
from home_mjx.viewer.browser.scene.poses import split_poses

if TYPE_CHECKING:
    import viser

MIN_MOVE = 1e-4  # [m] or unit of a quaternion: smaller changes of a pose are not sent
OVERVIEW_DIRECTION = np.array([-0.15, -0.45, 0.75])  # from the house to the first camera, in sizes of the house
MIN_OVERVIEW = 1.0  # [m], added to the size of a house


class SceneTree:
    """One house at a time in viser's scene.

    Args:
        server: viser's server.
        on_object: Callback with the group and the index in it of an instance that was clicked, on a viser thread.
        root: Path of the house in the scene; several trees need different ones.
    """

    def __init__(
        self, server: "viser.ViserServer", on_object: Callable[[InstanceGroup, int], None], root: str = "/house"
    ) -> None:
        self._server, self._on_object, self._root = server, on_object, root
        self._levels: dict[int, Any] = {}
        self._layers: dict[tuple[int, str], Any] = {}
        self._moving: list[tuple[InstanceGroup, list[Any]]] = []
        self._is_shown = {CEILING: False, OUTDOORS: False}
        self.house: HouseScene | None = None
        server.scene.set_up_direction("+z")
        server.scene.configure_default_lights(cast_shadow=False)
        server.scene.configure_environment_map("warehouse", environment_intensity=0.6)

    def load(self, house: HouseScene) -> None:
        """Replace the scene by a house, and set the first camera of new pages to an overview."""
        with self._server.atomic():
            for handle in self._levels.values():
                handle.remove()
            self._levels, self._layers, self._moving = {}, {}, []
            self.house = house
            for number, group in enumerate(house.groups):
                handles = self._add(number, group)
                if group.layer == MOVING:
                    self._moving.append((group, handles))
        self._frame(house)
        for layer, is_shown in self._is_shown.items():
            self.show_layer(layer, is_shown)

    def move(self, moving: DynamicInstances) -> None:
        """Move the dynamic instances to the poses of an environment in the same house; unchanged ones are not sent."""
        split = split_poses(np.asarray(moving.pose))
        with self._server.atomic():
            for number, (before, handles) in enumerate(self._moving):
                group = before.with_poses(split.pos, split.quat)
                if max(np.abs(group.pos - before.pos).max(), np.abs(group.quat - before.quat).max()) > MIN_MOVE:
                    _place(handles, group)
                    self._moving[number] = group, handles

    def show_level(self, level: int, is_shown: bool) -> None:
        """Show or hide one level of the house."""
        self._levels[level].visible = is_shown

    def show_layer(self, layer: str, is_shown: bool) -> None:
        """Show or hide a layer of all levels, such as `CEILING`, also of houses that are loaded later."""
        self._is_shown[layer] = is_shown
        for (_, name), handle in self._layers.items():
            if name == layer:
                handle.visible = is_shown

    def _add(self, number: int, group: InstanceGroup) -> list[Any]:
        """Add a group to the scene; return its handles."""
        scene, level = self._server.scene, f"{self._root}/level{group.level}"
        if group.level not in self._levels:
            self._levels[group.level] = scene.add_frame(level, show_axes=False)
        place = group.level, group.layer
        if place not in self._layers:
            self._layers[place] = scene.add_frame(f"{level}/{group.layer}", show_axes=False)
        handles = [
            self._add_mesh(f"{level}/{group.layer}/{number}.{n}", glb, group) for n, glb in enumerate(group.glbs)
        ]
        for handle in handles if group.objects[0] >= 0 else ():
            handle.on_click(lambda event: self._on_object(group, getattr(event, "instance_index", None) or 0))
        return handles

    def _add_mesh(self, name: str, glb: bytes, group: InstanceGroup) -> Any:
        """Add one mesh of a group; return its handle."""
        scene = self._server.scene
        look: dict[str, Any] = {"cast_shadow": False, "receive_shadow": False}
        if len(group.entries) == 1:
            scale, quat, pos = (tuple(values[0].tolist()) for values in (group.scale, group.quat, group.pos))
            return scene.add_glb(name, glb, scale=scale, wxyz=quat, position=pos, **look)
        scales = group.scale.astype(np.float32)
        return scene.add_batched_glb(name, glb, group.quat, group.pos, batched_scales=scales, lod="off", **look)

    def _frame(self, house: HouseScene) -> None:
        """Aim the cameras at the rooms of the house, from above."""
        centre, size = house.box.mean(axis=0), float(np.linalg.norm(house.box[1] - house.box[0])) + MIN_OVERVIEW
        position = centre + OVERVIEW_DIRECTION * size
        self._server.initial_camera.position, self._server.initial_camera.look_at = tuple(position), tuple(centre)
        for client in self._server.get_clients().values():
            client.camera.position, client.camera.look_at = position, centre


def _place(handles: list[Any], group: InstanceGroup) -> None:
    """Move the handles of a group to its poses."""
    for handle in handles:
        if len(group.entries) == 1:
            handle.position, handle.wxyz = group.pos[0], group.quat[0]
        else:
            handle.batched_positions = group.pos.astype(np.float32)
            handle.batched_wxyzs = group.quat.astype(np.float32)


class SceneObserver(Observer):
    """Scene that follows the first environment of a run: another house is loaded, poses are moved.

    Args:
        tree: The scene.
    """

    def __init__(self, tree: SceneTree) -> None:
        self.tree, self._house = tree, -1
        self._library: tuple[Any, ModelLibrary] | None = None

    def on_run_start(self, start: RunStart) -> None:
        """Store the environment, and make the program for its poses."""
        assert start.env is not None
        env: Env[HouseholdEnv] = start.env
        if self._library is None or self._library[0] is not env.params.bank:
            self._library = env.params.bank, ModelLibrary(env.bank)
            self._house = -1
        self._env = env
        self._moving = jax.jit(lambda params, state: env.core.snapshot(params, state).scene.moving)

    def on_episode_step(self, step: EpisodeStep) -> None:
        """Move the scene, or load another house."""
        assert self._library is not None
        moving = jax.tree.map(np.asarray, self._moving(self._env.params, step.state))
        house = int(step.state.world.house)
        if house == self._house:
            self.tree.move(moving)
        else:
            self._house = house
            self.tree.load(HouseScene(self._env.bank, house, moving, self._library[1]))
