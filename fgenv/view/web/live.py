"""A live view of a simulator's world in the browser, with a panel of what to show."""

from __future__ import annotations

import threading
import time
from typing import TYPE_CHECKING

import numpy as np

from fgenv.arrays import Floats
from fgenv.envs import Simulator

from .overlays import Overlays
from .scenery import Scenery
from .server import PORT, serve, stop

if TYPE_CHECKING:
    import viser

GONE = 2  # of a simulator's status
RATE = 25.0  # pictures a second while robots move
NOBODY, ALL = "nobody", "all robots"
SPEEDS = ("0.1x", "0.25x", "0.5x", "1x", "2x", "4x", "8x", "fastest")


class Live:
    """Shows one world at `http://127.0.0.1:port`, to as many browsers as come.

    >>> live = Live(simulator)
    >>> print(live.url)
    >>> live.begin()                  # after each reset
    >>> live.show()                   # after each step: takes as long as the step, at speed 1x

    `show` waits while it is paused in the browser, and lets single steps go.

    Args:
        corners: (n, 3), meters, of more that the camera is to see.
        port: 0: any that is free.

    Raises:
        ValueError: the port is taken, or none.
        ImportError: viser is missing, with the remedy.
    """

    def __init__(
        self, simulator: Simulator, port: int = PORT, corners: Floats | None = None
    ) -> None:
        self.simulator = simulator
        self.server: viser.ViserServer = serve(port, f"fgenv: {simulator.scenario.name}")
        self.scenery = Scenery(self.server.scene, simulator.built, corners)
        self.overlays = Overlays(self.server.scene, self.scenery, simulator)
        self._go, self._steps = threading.Event(), threading.Semaphore(0)
        self._go.set()
        self.restart, self._changed = threading.Event(), threading.Event()
        self.updates = 0  # pictures shown
        self._before = self.simulator.built.starts[0][:0]
        self._due = time.monotonic()
        camera, view = self.scenery.camera, self.server.initial_camera
        view.position, view.look_at, view.fov = camera.eye, camera.target, camera.fov
        self._panel()

    @property
    def url(self) -> str:
        """Where it is."""
        return f"http://{self.server.get_host()}:{self.server.get_port()}"

    def begin(self, world: int = 0) -> None:
        """An episode begins: show where all stand."""
        self.overlays.note(world, begins=True)
        self.restart.clear()
        self._before = self.simulator.configurations[world]
        with self.server.atomic():
            goals = self.simulator.goals[world]
            self.scenery.aim(list(goals))
            self.scenery.move_standing(self.simulator.standing_poses(world))
        self._picture(world, self.simulator.configurations[world])
        self._last(world)
        self._due = time.monotonic()

    def show(self, world: int = 0) -> None:
        """Show the step just made, in the time that it takes; waits where it is paused."""
        now = self.simulator.configurations[world]
        before, seconds = self._before, self._seconds()
        count = max(1, round(RATE * seconds))
        for k in range(1, count + 1):
            self._picture(world, self._between(before, now, k / count))
            self._due += seconds / count
            self._rest()
        self.overlays.note(world)
        self._last(world)
        self._before = now
        self._hold(world)

    def close(self) -> None:
        """Stop the server."""
        stop(self.server)

    def _seconds(self) -> float:
        """That a step is to take."""
        speed = str(self._speed.value)
        return 0.0 if speed == "fastest" else self.simulator.dt / float(speed.rstrip("x"))

    def _rest(self) -> None:
        late = time.monotonic() - self._due
        if late > 0.5:
            self._due = time.monotonic()  # too slow, or it was paused: do not hurry after it
        elif late < 0:
            time.sleep(-late)

    def _hold(self, world: int) -> None:
        """Wait while it is paused, but for a step that is asked for."""
        while not self._go.is_set() and not self.restart.is_set():
            if self._steps.acquire(timeout=0.05):
                break
            self.refresh(world)

    def rest(self, seconds: float, world: int = 0) -> None:
        """Show the current state for a while, or until the viewer asks for a new episode."""
        end = time.monotonic() + seconds
        while not self.restart.is_set() and (time.monotonic() < end or not self._go.is_set()):
            self.refresh(world)
            time.sleep(0.05)

    def refresh(self, world: int = 0) -> None:
        """Show what has been switched on since, and wipe away what was switched off."""
        if self._changed.is_set():
            self._changed.clear()
            self._last(world)

    def _between(self, before: Floats, now: Floats, t: float) -> Floats:
        if t == 1.0:
            return now
        found = now.copy()
        for i, robot in enumerate(self.simulator.robots):
            nq = robot.nq
            found[i, :nq] = robot.interpolate(before[i, :nq], now[i, :nq], t)
        return found

    def _picture(self, world: int, q: Floats) -> None:
        here = (self.simulator.status[world] != GONE).tolist()
        poses = self.scenery.robots.poses(list(q))
        with self.server.atomic():
            self.scenery.robots.move(poses, here)
        self._pursue(q)
        self.updates += 1

    def _last(self, world: int) -> None:
        """What is shown of a step only when it is made."""
        with self.server.atomic():
            self.overlays.draw(world)
        simulator = self.simulator
        arrived = int((simulator.status[world] != 0).sum())
        met = int(simulator.collision_counts[world].sum())
        self._told.content = (
            f"**{simulator.steps[world] * simulator.dt:.1f} s**, step {simulator.steps[world]}"
            f" of {simulator.horizon}; {arrived} of {simulator.n_robots} arrived;"
            f" {met} robot steps in contact"
        )

    def _pursue(self, q: Floats) -> None:
        """Carry the cameras along with the robot that is followed."""
        name = str(self._follow.value)
        if name == NOBODY:
            self._at: Floats | None = None
            return
        i = self.simulator.names.index(name)
        robot = self.simulator.robots[i]
        at = robot.forward(q[i, : robot.nq], robot.root)[:3, 3]
        for client in self.server.get_clients().values():
            by = at - (client.camera.look_at if self._at is None else self._at)
            if np.abs(by).max() > 1e-9:
                with client.atomic():  # the target comes along with the eye
                    client.camera.position = client.camera.position + by
        self._at = at

    def _panel(self) -> None:
        gui, self._at = self.server.gui, None
        gui.configure_theme(show_logo=False, show_share_button=False)
        gui.main_panel.dock_right()  # beside the scene: nothing is under it
        self._told = gui.add_markdown("")
        run = gui.add_button_group("Run", ("Pause", "Play", "Step"))
        self._speed = gui.add_dropdown("Speed", SPEEDS, initial_value="1x")
        names = (NOBODY, *self.simulator.names)
        self._follow = gui.add_dropdown("Follow", names, initial_value=NOBODY)
        again = gui.add_button("New episode")
        with gui.add_folder("Show"):
            whose = gui.add_dropdown(
                "Whose", (ALL, *self.simulator.names), hint="clearances, boxes, masks and rays"
            )
            for name in ("goals", *Overlays.NAMES):
                self._toggle(name)

        @run.on_click
        def _(_: object) -> None:
            if run.value == "Play":
                self._go.set()
            else:
                self._go.clear()
                if run.value == "Step":
                    self._steps.release()

        @whose.on_update
        def _(_: object) -> None:
            one = None if whose.value == ALL else self.simulator.names.index(str(whose.value))
            self.overlays.whose = one
            self._changed.set()

        @again.on_click
        def _(_: object) -> None:
            self.restart.set()

    def _toggle(self, name: str) -> None:
        on = name == "goals" or self.overlays.on[name]
        box = self.server.gui.add_checkbox(name.capitalize(), on)

        @box.on_update
        def _(_: object) -> None:
            if name == "goals":
                for flock in self.scenery.goals.flocks:
                    flock.handle.visible = box.value
            else:
                self.overlays.on[name] = box.value
                self._changed.set()
