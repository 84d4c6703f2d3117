"""A live view of a simulator's world in the browser."""

from __future__ import annotations

import secrets
import socket
import time
from typing import TYPE_CHECKING

import numpy as np

from fgenv.arrays import Floats
from fgenv.envs import Simulator
from fgenv.envs.state_readers import GONE, MOVING
from fgenv.view.robot_poses import base_position

from .overlays import Overlays
from .panel import Panel
from .scene import ScenarioScene
from .server import HOST, PORT, serve, stop

if TYPE_CHECKING:
    import viser

RATE = 25.0  # frames per second while robots move
MAX_DELAY = 0.5  # seconds; a view that is later does not catch up
POLL = 0.05  # seconds between two checks of the panel


class Live:
    """Shows one world at `http://127.0.0.1:port` to any number of browsers.

    >>> live = Live(simulator)
    >>> print(live.url)
    >>> live.begin()                  # after each reset
    >>> live.show()                   # after each step; takes the time of the step at speed 1x

    `show` waits while the view is paused in the browser.

    Args:
        corners: (n, 3), meters, of more that the camera has to see.
        port: 0: any free port.
        host: address of a network interface, such as 0.0.0.0, which other machines can reach; `url`
            then has a token that browsers need. None: this machine alone.

    Raises:
        ValueError: an invalid port, or one in use.
        ImportError: viser is missing, with the remedy.
    """

    def __init__(
        self,
        simulator: Simulator,
        port: int = PORT,
        corners: Floats | None = None,
        *,
        host: str | None = None,
    ) -> None:
        self.simulator = simulator
        self._token = "" if host is None else secrets.token_urlsafe(16)
        label = f"fgenv: {simulator.scenario.name}"
        self.server: viser.ViserServer = serve(port, label, host or HOST, self._token)
        self.scene = ScenarioScene(self.server.scene, simulator.built, corners)
        self.overlays = Overlays(self.server.scene, self.scene, simulator)
        self.panel = Panel(self.server, simulator.names, self.overlays, self.scene)
        self.frames = 0  # shown so far
        self._before = self.simulator.built.starts[0][:0]
        self._followed_at: Floats | None = None
        self._due = time.monotonic()
        camera, initial = self.scene.camera, self.server.initial_camera
        initial.position, initial.look_at, initial.fov = camera.eye, camera.target, camera.fov

    @property
    def url(self) -> str:
        """Address of the page."""
        host = self.server.get_host()
        if host in ("0.0.0.0", "::"):  # all interfaces
            host = socket.gethostname()
        name = f"[{host}]" if ":" in host else host
        query = f"/?token={self._token}" if self._token else ""
        return f"http://{name}:{self.server.get_port()}{query}"

    def begin(self, world: int = 0) -> None:
        """Show the beginning of an episode."""
        self.overlays.record_step(world, begins=True)
        self.panel.restart.clear()
        self._before = self.simulator.configurations[world]
        with self.server.atomic():
            self.scene.set_goals(list(self.simulator.goals[world]))
            self.scene.move_static(self.simulator.static_poses(world))
        self._show_robots(world, self.simulator.configurations[world])
        self._show_step(world)
        self._due = time.monotonic()

    def show(self, world: int = 0) -> None:
        """Show the last step at the chosen speed, and wait while the view is paused."""
        before, after = self._before, self.simulator.configurations[world]
        speed = self.panel.speed
        seconds = 0.0 if speed is None else self.simulator.dt / speed
        count = max(1, round(RATE * seconds))
        for k in range(1, count + 1):
            self._show_robots(world, self._interpolate(before, after, k / count))
            self._due += seconds / count
            self._wait_until_due()
        self.overlays.record_step(world)
        self._show_step(world)
        self._before = after
        self._wait_while_paused(world)

    def close(self) -> None:
        """Stop the server."""
        stop(self.server)

    def rest(self, seconds: float, world: int = 0) -> None:
        """Show the current state for a time, or until a new episode is requested."""
        end, panel = time.monotonic() + seconds, self.panel
        while not panel.restart.is_set() and (time.monotonic() < end or not panel.running.is_set()):
            self.refresh(world)
            time.sleep(POLL)

    def refresh(self, world: int = 0) -> None:
        """Redraw the overlays if their selection changed."""
        if self.panel.changed.is_set():
            self.panel.changed.clear()
            self._show_step(world)

    def _wait_until_due(self) -> None:
        delay = time.monotonic() - self._due
        if delay > MAX_DELAY:
            self._due = time.monotonic()
        elif delay < 0:
            time.sleep(-delay)

    def _wait_while_paused(self, world: int) -> None:
        """Wait until the view runs, a single step or a new episode is requested."""
        panel = self.panel
        while not panel.running.is_set() and not panel.restart.is_set():
            if panel.single_steps.acquire(timeout=POLL):
                break
            self.refresh(world)

    def _interpolate(self, before: Floats, after: Floats, t: float) -> Floats:
        if t == 1.0:
            return after
        q = after.copy()
        for i, robot in enumerate(self.simulator.robots):
            nq = robot.nq
            q[i, :nq] = robot.interpolate(before[i, :nq], after[i, :nq], t)
        return q

    def _show_robots(self, world: int, q: Floats) -> None:
        present = (self.simulator.status[world] != GONE).tolist()
        poses = self.scene.robots.poses(list(q))
        with self.server.atomic():
            self.scene.robots.move(poses, present)
        self._follow_robot(q)
        self.frames += 1

    def _show_step(self, world: int) -> None:
        """Show the overlays and the status after a step."""
        with self.server.atomic():
            self.overlays.draw(world)
        simulator = self.simulator
        arrived = int((simulator.status[world] != MOVING).sum())
        contacts = int(simulator.collision_counts[world].sum())
        self.panel.show_status(
            f"**{simulator.steps[world] * simulator.dt:.1f} s**, step {simulator.steps[world]}"
            f" of {simulator.horizon}; {arrived} of {simulator.n_robots} arrived;"
            f" {contacts} steps in contact"
        )

    def _follow_robot(self, q: Floats) -> None:
        """Move the cameras with the robot that is followed."""
        i = self.panel.followed
        if i is None:
            self._followed_at = None
            return
        base = base_position(self.simulator.robots[i], q[i])
        for client in self.server.get_clients().values():
            last = client.camera.look_at if self._followed_at is None else self._followed_at
            if np.abs(base - last).max() > 1e-9:
                with client.atomic():  # the target moves with the eye
                    client.camera.position = client.camera.position + (base - last)
        self._followed_at = base
