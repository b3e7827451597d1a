"""Viewer of houses side by side: one 3D scene of all, cards of objects, the plan by our renderer, and findings."""

import json
import threading
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np

from home_mjx.bank.bank import HouseBank
from home_mjx.raycast_render.cameras.camera import Camera, Lens
from home_mjx.raycast_render.images.render import render
from home_mjx.raycast_render.scene.scene import make_open_scene
from home_mjx.viewer.browser.controls import name_houses
from home_mjx.viewer.browser.live_camera import encode_jpeg
from home_mjx.viewer.browser.markdown import format_list, format_table
from home_mjx.viewer.browser.object_card import format_card
from home_mjx.viewer.browser.run import ViewOptions, print_address
from home_mjx.viewer.browser.scene.house_scene import CEILING, OUTDOORS, HouseScene, InstanceGroup
from home_mjx.viewer.browser.scene.models import ModelLibrary
from home_mjx.viewer.browser.scene.scene_tree import SceneTree
from home_mjx.viewer.browser.serving.server import ViewServer
from home_mjx.viewer.gallery.findings import PlacedFinding
from home_mjx.viewer.gallery.layout import find_boxes, look_at, place_side_by_side
from home_mjx.viewer.pictures.top_view import CUT_HEIGHT, frame_house

MAX_LISTED = 12  # findings of a house that are listed
LABEL_HEIGHT = 0.25  # [m], of findings and names of houses
ABOVE = 1.2  # [m], of the camera over the cut


class GalleryViewer:
    """Houses of a bank side by side in browser pages; use it as a context.

    Args:
        bank: The houses, with doors open.
        options: Address, and options of the picture.
        findings: Findings of the validator by house id; houses without an entry were not checked.

    Attributes:
        server: The server; `server.address` is the page's.

    Raises:
        ConfigError: The extra `view` is not installed, or no port is free.
    """

    def __init__(
        self,
        bank: HouseBank,
        options: ViewOptions | None = None,
        findings: Mapping[str, Sequence[PlacedFinding]] | None = None,
    ) -> None:
        self.bank, self.options, self._findings = bank, options or ViewOptions(), findings or {}
        self._names, self._pictures = name_houses(bank.house_ids), dict[int, bytes]()
        self._chosen, self._end, self._lock = 0, threading.Event(), threading.RLock()
        self._see = jax.jit(self._plan)
        self.server = ViewServer(self.options.host, self.options.port, greeting=self._greet)
        try:
            self._add_scene()
            self._add_panels()
        except BaseException:
            self.server.close()
            raise

    def __enter__(self) -> "GalleryViewer":
        return self

    def __exit__(self, *error: object) -> None:
        self.server.close()

    def run(self) -> None:
        """Serve until `stop` or an interrupt."""
        self._draw()
        while not self._end.wait(0.5):
            pass

    def stop(self) -> None:
        """End `run`; from any thread."""
        self._end.set()

    def choose(self, name: str) -> None:
        """Show a house by its name: figures, findings and plan; the cameras of all pages go there."""
        with self._lock:
            self._chosen = house = self._names.index(name)
            self._show_figures(house)
            self._frame(self._boxes[house] + self._shifts[house])
        self._draw()

    def _add_scene(self) -> None:
        """Add all houses side by side, and aim the cameras at them."""
        self._boxes, library = find_boxes(self.bank), ModelLibrary(self.bank)
        self._shifts = place_side_by_side(self._boxes)
        self._trees = [self._add_house(house, library) for house in range(self.bank.num_houses)]
        moved = self._boxes + self._shifts[:, None]
        self._frame(np.stack([moved.min((0, 1)), moved.max((0, 1))]))

    def _add_house(self, house: int, library: ModelLibrary) -> SceneTree:
        """Add a house with its name and findings to the scene, at its place."""
        scene, root = self.server.scene.scene, f"/gallery/{house}"
        scene.add_frame(root, show_axes=False, position=(*self._shifts[house].tolist(), 0.0))
        tree = SceneTree(self.server.scene, lambda group, index: self._show_card(house, group, index), root)
        moving = jax.tree.map(np.asarray, make_open_scene(self.bank, house).moving)
        tree.load(HouseScene(self.bank, house, moving, library))
        low, high = self._boxes[house]
        look: dict[str, Any] = {"font_size_mode": "scene", "font_scene_height": 2 * LABEL_HEIGHT}
        scene.add_label(f"{root}/name", self._names[house], position=(*((low + high) / 2).tolist(), 3.5), **look)
        for number, (finding, place) in enumerate(self._findings.get(self.bank.house_ids[house], ())):
            if place is not None:
                where = tuple(place.tolist())
                text = f"{finding.severity}: {finding.rule}"
                scene.add_icosphere(f"{root}/findings/{number}", 0.1, color=(235, 60, 60), position=where)
                look = {"font_size_mode": "scene", "font_scene_height": LABEL_HEIGHT, "position": where}
                scene.add_label(f"{root}/findings/{number}/text", text, **{**look, "position": (0.0, 0.0, 0.15)})
        return tree

    def _frame(self, box: np.ndarray) -> None:
        """Aim the cameras of all pages at a box in plan (low, high) [m], from above."""
        camera, (place, middle) = self.server.scene.initial_camera, look_at(box)
        camera.position, camera.look_at = tuple(place), tuple(middle)
        for client in self.server.scene.get_clients().values():
            client.camera.position, client.camera.look_at = place, middle

    def _add_panels(self) -> None:
        """Add the list of houses, figures, the card and the layers."""
        gui = self.server.scene.gui
        gui.configure_theme(dark_mode=True, show_logo=False, show_share_button=False)
        with gui.add_folder("Houses"):
            house = gui.add_dropdown("house", self._names, initial_value=self._names[0])
            house.on_update(lambda event: self.choose(house.value))
            self._figures = gui.add_markdown("")
            for text, layer in (("ceilings", CEILING), ("outdoors and roofs", OUTDOORS)):
                self._add_layer(text, layer)
        with gui.add_folder("Object"):
            self._card = gui.add_markdown("Click on an object.")
        self._show_figures(self._chosen)

    def _add_layer(self, text: str, layer: str) -> None:
        """Add the checkbox of a layer of all houses."""
        control = self.server.scene.gui.add_checkbox(text, initial_value=False)
        control.on_update(lambda event: self._show_layer(layer, control.value))

    def _show_layer(self, layer: str, is_shown: bool) -> None:
        """Show or hide a layer of all houses."""
        for tree in self._trees:
            tree.show_layer(layer, is_shown)

    def _show_figures(self, house: int) -> None:
        """Show counts and findings of a house."""
        bank = self.bank
        rooms = np.asarray(bank.navigation.room_type[house])
        rows = {
            "house": bank.house_ids[house],
            "storeys": int(np.isfinite(np.asarray(bank.navigation.floor[house])).sum()),
            "rooms": int((rooms >= 0).sum()),
            "objects": int((np.asarray(bank.geometry.instance_model[house]) >= 0).sum()) - 1,
            "walkable area": f"{float(bank.navigation.num_cells[house]) * bank.spec.cell**2:.0f} m²",
        }
        found = self._findings.get(bank.house_ids[house])
        rows["findings"] = "not checked" if found is None else len(found)
        listed = format_list((f.severity, f"{f.element}: {f.message}", True) for f, _ in (found or ())[:MAX_LISTED])
        self._figures.content = f"{format_table(rows)}\n\n{listed}"

    def _show_card(self, house: int, group: InstanceGroup, index: int) -> None:
        """Show the card of a clicked object; on a viser thread."""
        self._card.content = format_card(self.bank, house, group, index)

    def _draw(self) -> None:
        """Render the plan of the chosen house, and send it, unless another one was chosen meanwhile."""
        with self._lock:
            house = self._chosen
        if house not in self._pictures:
            low, _, side = frame_house(self.bank, house)
            camera = Camera(jnp.asarray([*(low + side / 2), 0.0], jnp.float32), jnp.eye(1, 4)[0], jnp.float32(side))
            self._pictures[house] = encode_jpeg(np.asarray(self._see(self.bank, jnp.int32(house), camera)))
        with self._lock:
            if house == self._chosen:
                self.server.live.publish(self._greet())

    def _plan(self, bank: HouseBank, house: Any, camera: Camera) -> Any:
        """Return the plan of a house's lowest storey; to be jitted."""
        cut = bank.navigation.floor[house, 0] + CUT_HEIGHT
        camera = camera.replace(pos=camera.pos.at[2].set(cut + ABOVE))
        picture, scene = self.options.picture, make_open_scene(bank, house)
        lens = Lens(picture.size, picture.size, "orthographic")
        return render(scene, camera, lens, kinds=("rgb",), shader=picture.shader, cut_height=cut)["rgb"]

    def _greet(self) -> str:
        """Return the state for a page, and send it the plan."""
        house = self._chosen
        if house in self._pictures:
            self.server.live.publish(self._pictures[house])
        count = f"{self.bank.num_houses} houses side by side"
        caption = f"plan of {self._names[house]}: {self.options.picture.shader}, {self.options.picture.size} px"
        return json.dumps({"instruction": count, "status": "", "caption": caption, "drives": False, "sound": False})


def run_gallery(
    bank: HouseBank,
    options: ViewOptions,
    print_line: Callable[[str], Any],
    findings: Mapping[str, Sequence[PlacedFinding]] | None = None,
) -> None:
    """Serve houses side by side, print the address, and run until an interrupt; raises as `GalleryViewer`."""
    with GalleryViewer(bank, options, findings) as viewer:
        print_address(options, viewer.server, print_line)
        viewer.run()
