"""The control panel of a live view: run, speed, follow, overlays."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import viser

    from .overlays import Overlays
    from .scene import ScenarioScene

NO_ROBOT, ALL_ROBOTS = "nobody", "all robots"
FASTEST = "fastest"
SPEEDS = ("0.1x", "0.25x", "0.5x", "1x", "2x", "4x", "8x", FASTEST)


class Panel:
    """Controls in the browser.

    Attributes:
        running: set unless the view is paused.
        single_steps: steps that were requested while paused.
        restart: set once a new episode is requested.
        changed: set when the selection of overlays changes.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        names: Sequence[str],
        overlays: Overlays,
        scene: ScenarioScene,
    ) -> None:
        self.running, self.single_steps = threading.Event(), threading.Semaphore(0)
        self.running.set()
        self.restart, self.changed = threading.Event(), threading.Event()
        self._gui, self._names, self._overlays, self._scene = server.gui, names, overlays, scene
        self._gui.configure_theme(show_logo=False, show_share_button=False)
        self._gui.main_panel.dock_right()  # beside the scene, hiding nothing
        self._status = self._gui.add_markdown("")
        self._add_run_buttons()
        self._speed = self._gui.add_dropdown("Speed", SPEEDS, initial_value="1x")
        self._follow = self._gui.add_dropdown("Follow", (NO_ROBOT, *names), initial_value=NO_ROBOT)
        self._add_restart_button()
        with self._gui.add_folder("Show"):
            self._add_robot_choice()
            self._add_goal_checkbox()
            for name in overlays.NAMES:
                self._add_overlay_checkbox(name)

    @property
    def speed(self) -> float | None:
        """Simulated seconds per second; None: as fast as possible."""
        value = str(self._speed.value)
        return None if value == FASTEST else float(value.rstrip("x"))

    @property
    def followed(self) -> int | None:
        """The robot that the camera follows."""
        name = str(self._follow.value)
        return None if name == NO_ROBOT else self._names.index(name)

    def show_status(self, text: str) -> None:
        """Show a line of Markdown at the top of the panel."""
        self._status.content = text

    def _add_run_buttons(self) -> None:
        run = self._gui.add_button_group("Run", ("Pause", "Play", "Step"))

        @run.on_click
        def _(_: object) -> None:
            if run.value == "Play":
                self.running.set()
            else:
                self.running.clear()
                if run.value == "Step":
                    self.single_steps.release()

    def _add_restart_button(self) -> None:
        button = self._gui.add_button("New episode")

        @button.on_click
        def _(_: object) -> None:
            self.restart.set()

    def _add_robot_choice(self) -> None:
        choice = self._gui.add_dropdown(
            "Whose", (ALL_ROBOTS, *self._names), hint="clearances, boxes, masks and rays"
        )

        @choice.on_update
        def _(_: object) -> None:
            name = str(choice.value)
            self._overlays.robot = None if name == ALL_ROBOTS else self._names.index(name)
            self.changed.set()

    def _add_goal_checkbox(self) -> None:
        box = self._gui.add_checkbox("Goals", True)

        @box.on_update
        def _(_: object) -> None:
            for mesh in self._scene.goals.meshes:
                mesh.handle.visible = box.value

    def _add_overlay_checkbox(self, name: str) -> None:
        box = self._gui.add_checkbox(name.capitalize(), self._overlays.on[name])

        @box.on_update
        def _(_: object) -> None:
            self._overlays.on[name] = box.value
            self.changed.set()
