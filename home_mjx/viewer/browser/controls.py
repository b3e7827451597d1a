"""Controls of picture and scene, which sessions and replays share."""

import dataclasses
from collections import Counter
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from home_mjx.datasets.seeds import HouseKey, parse_house_id
from home_mjx.viewer.browser.broadcast import Broadcast
from home_mjx.viewer.browser.free_camera import FreeCamera
from home_mjx.viewer.browser.live_camera import PICTURES, SHADERS
from home_mjx.viewer.browser.overlays import Overlays
from home_mjx.viewer.browser.scene.house_scene import CEILING, OUTDOORS
from home_mjx.viewer.episodes.viewpoints import VIEWPOINTS

if TYPE_CHECKING:
    import viser

SIZES = ("128", "256", "384", "512", "768")


class ViewControls:
    """Folders `Object`, hidden until `show_card`, and after `add_folders` also `Picture` and `Scene`, in viser's panel.

    Args:
        server: viser's server.
        broadcast: Scene and picture.
        overlays: Overlays of the scene.
        post: Function that runs a command on the simulation's thread.
    """

    def __init__(
        self,
        server: "viser.ViserServer",
        broadcast: Broadcast,
        overlays: Overlays,
        post: Callable[[Callable[[], Any]], None],
    ) -> None:
        self._server, self._broadcast, self._overlays, self._post = server, broadcast, overlays, post
        self._levels: list[Any] = []
        self._free = FreeCamera(broadcast, post)
        server.on_client_connect(self._free.follow)
        self._card_folder = server.gui.add_folder("Object", visible=False)
        with self._card_folder:
            self._card = server.gui.add_markdown("")

    def show_card(self, text: str) -> None:
        """Show the card of a clicked object (Markdown)."""
        self._card.content, self._card_folder.visible = text, True

    def add_folders(self) -> None:
        """Add the folders `Picture` and `Scene`."""
        with self._server.gui.add_folder("Picture"):
            self._add_picture()
        self._scene = self._server.gui.add_folder("Scene")
        with self._scene:
            for name, is_shown in self._overlays.is_shown.items():
                self._add_overlay(name, is_shown)
            for text, layer in (("ceilings", CEILING), ("outdoors and roofs", OUTDOORS)):
                self._add_layer(text, layer)

    def show_levels(self) -> None:
        """Show a checkbox for each level of the house."""
        tree = self._broadcast.tree
        for control in self._levels:
            control.remove()
        self._levels = []
        for level in tree.house.levels if tree.house is not None else ():
            with self._scene:
                control = self._server.gui.add_checkbox(f"storey {level}", initial_value=True)
            control.on_update(lambda event, level=level, control=control: tree.show_level(level, control.value))
            self._levels.append(control)

    def _add_picture(self) -> None:
        """Add kind, shader and size of the picture."""
        gui, options = self._server.gui, self._broadcast.options
        controls = {
            "viewpoint": gui.add_dropdown("camera", VIEWPOINTS, initial_value=options.viewpoint),
            "kind": gui.add_dropdown("picture", tuple(PICTURES), initial_value=options.kind),
            "shader": gui.add_dropdown("shader", unique(*SHADERS, options.shader), initial_value=options.shader),
            "size": gui.add_dropdown("size [px]", unique(*SIZES, str(options.size)), initial_value=str(options.size)),
        }
        for name, control in controls.items():
            control.on_update(lambda event, name=name, control=control: self._set_picture(name, control.value))

    def _set_picture(self, name: str, value: str) -> None:
        """Change one option of the picture, and draw it."""
        changes: dict[str, Any] = {name: int(value) if name == "size" else value}
        self._broadcast.options = dataclasses.replace(self._broadcast.options, **changes)
        self._post(self._broadcast.draw)

    def _add_overlay(self, name: str, is_shown: bool) -> None:
        """Add the checkbox of an overlay."""
        control = self._server.gui.add_checkbox(name, initial_value=is_shown)
        control.on_update(lambda event: self._post(lambda: self._overlays.show(name, control.value)))

    def _add_layer(self, text: str, layer: str) -> None:
        """Add the checkbox of a layer that is hidden at first."""
        control = self._server.gui.add_checkbox(text, initial_value=False)
        control.on_update(lambda event: self._broadcast.tree.show_layer(layer, control.value))


def name_houses(ids: Sequence[str]) -> tuple[str, ...]:
    """Return distinct names of houses for a person: the seeds of generated ones, the ids of others.

    Example:
        >>> from home_mjx.datasets.seeds import house_id
        >>> name_houses((house_id(40, 0x500), house_id(41, 0x500), house_id(41, 0x501), "hotel"))
        ('seed 40', 'seed 41, variant 500', 'seed 41, variant 501', 'hotel')
    """
    keys = [parse_house_id(name) for name in ids]
    count = Counter(key.seed for key in keys if key is not None)

    def describe(name: str, key: HouseKey | None) -> str:
        """Return the name of one house."""
        if key is None:
            return name
        return f"seed {key.seed}" if count[key.seed] == 1 else f"seed {key.seed}, variant {key.variant:x}"

    return tuple(describe(name, key) for name, key in zip(ids, keys, strict=True))


def unique(*names: str) -> tuple[str, ...]:
    """Return names without repetitions, in order.

    Example:
        >>> unique("fast", "lit", "fast")
        ('fast', 'lit')
    """
    return tuple(dict.fromkeys(names))
