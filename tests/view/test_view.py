"""The live view: its geometry, its clock, and its page in a browser."""

import copy
import socket
import threading
import time
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from support.browser import CHROMIUM, Page, page
from support.shell import Shell

import fgenv
from fgenv.envs import Simulator, View, policy_of

pytest.importorskip("viser")
from fgenv.view.web import live as live_module
from fgenv.view.web import overlay_geometry
from fgenv.view.web.live import Live
from fgenv.view.web.overlays import Overlays


class Clock:
    """A clock that only sleeping advances, in place of the module `time`."""

    now = 0.0

    def monotonic(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += seconds


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(live_module, "time", clock)
    return clock


@pytest.fixture
def live() -> Iterator[Live]:
    simulator = Simulator("warehouse", n=4, autoreset=False)
    observations = simulator.reset(seed=0)
    policy = policy_of("goto")
    policy.reset(View(simulator))
    live = Live(simulator, 0)
    choose(live.panel._speed, "fastest")
    live.begin()
    for _ in range(10):
        observations = simulator.step(policy.act(observations)).observations
        live.show()
    yield live
    live.close()


def test_a_port_that_is_taken_is_an_error(live: Live, shell: Shell) -> None:
    port = live.server.get_port()
    with pytest.raises(ValueError, match=f"port: {port} is taken"):
        Live(live.simulator, port)
    said = shell.refuses("view", "swap", "--port", port)
    assert f"port: {port} is taken; choose another one" in said


def test_candidates_are_the_worlds_own(live: Live) -> None:
    simulator, snapshot = live.simulator, live.overlays.snapshot(0)
    found = sum(len(snapshot.world.candidates(name)) for name in simulator.names)
    ends, colors = overlay_geometry.mask_lines(snapshot)
    assert ends.shape == (found, 2, 3)
    assert len(colors) == found > 0
    boxes, _ = overlay_geometry.motion_boxes(snapshot)
    assert boxes.shape == (12 * len(simulator.names), 2, 3)


def test_what_is_drawn_of_one_robot_is_its_part_of_what_is_drawn_of_all(live: Live) -> None:
    simulator, every = live.simulator, live.overlays.snapshot(0)
    of_all, ones = [np.empty((0, 2, 3))], set[str]()
    for i, name in enumerate(simulator.names):
        live.overlays.robot = i
        one = live.overlays.snapshot(0)
        found = every.world.candidates(name).tolist()
        assert overlay_geometry.masked_bodies(one) == {
            every.world.record(body).name for body in found
        }
        ones |= overlay_geometry.masked_bodies(one)
        of_all.append(overlay_geometry.mask_lines(one)[0])
        assert len(overlay_geometry.clearance_lines(one)[0]) == 1
    np.testing.assert_array_equal(np.concatenate(of_all), overlay_geometry.mask_lines(every)[0])
    assert ones == overlay_geometry.masked_bodies(every)


def test_lines_of_masks_are_over_their_robot(live: Live) -> None:
    for i, name in enumerate(live.simulator.names):
        live.overlays.robot = i
        snapshot = live.overlays.snapshot(0)
        parts = [snapshot.world.record(part) for part in snapshot.world.parts(name).tolist()]
        points = [p.shape.vertices @ p.pose[:3, :3].T + p.pose[:3, 3] for p in parts]
        highest = np.concatenate(points)[:, 2].max()
        assert (overlay_geometry.mask_lines(snapshot)[0][..., 2] > highest).all()


def test_clearance_lines_are_as_long_as_the_clearances(live: Live) -> None:
    simulator = live.simulator
    world, q = simulator.world(), simulator.configurations[0]
    ends, _ = overlay_geometry.clearance_lines(live.overlays.snapshot(0))
    lengths = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1)
    expected = [
        float(world.clearance(robot.name, row[: robot.nq]).distance)
        for robot, row in zip(simulator.robots, q, strict=True)
    ]
    np.testing.assert_allclose(lengths, expected, atol=1e-9)


def test_rays_end_on_what_stands_there(live: Live) -> None:
    simulator = live.simulator
    world = simulator.world()
    ends, _ = overlay_geometry.lidar_rays(live.overlays.snapshot(0))
    n = len(ends) // simulator.n_robots
    for i, robot in enumerate(simulator.robots):
        mine = ends[i * n : (i + 1) * n]
        by = mine[:, 1] - mine[:, 0]
        far = np.linalg.norm(by, axis=1)
        found = world.raycast(mine[:, 0], by / far[:, None], ignore=robot.name)
        lidar = simulator.scenario.models[simulator.scenario.robots[i].model].lidar
        assert lidar is not None
        np.testing.assert_allclose(np.minimum(found.distance, lidar.range), far, atol=1e-5)


def test_at_the_fastest_speed_each_step_is_one_frame_without_delay(clock: Clock) -> None:
    simulator = Simulator("warehouse", n=64, autoreset=False)
    simulator.reset(seed=0)
    live = Live(simulator, 0)
    choose(live.panel._speed, "fastest")
    live.begin()
    for _ in range(20):
        live.show()
    live.close()
    assert live.frames == 21
    assert clock.now == 0.0


def test_human_mode_returns_none_and_starts_when_first_rendered(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], clock: Clock
) -> None:
    monkeypatch.setenv("FGENV_VIEW_PORT", "0")
    env = fgenv.parallel_env("swap", n=2, render_mode="human")
    with pytest.raises(RuntimeError, match="before the first reset"):
        env.render()
    env.reset(seed=0)
    assert env._screen.live is None
    assert env.render() is None
    live = env._screen.live
    assert isinstance(live, Live)
    assert f"live view at {live.url}" in capsys.readouterr().err
    env.step({name: np.zeros(2) for name in env.agents})
    assert env.render() is None
    assert clock.now == pytest.approx(env.simulator.dt)  # in real time
    other = copy.deepcopy(env)
    assert other._screen.live is None
    env.close()
    with pytest.raises(OSError, match="refused"):
        socket.create_connection(("127.0.0.1", int(live.url.rpartition(":")[2])), timeout=5)


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
def test_in_a_browser_it_shows_robots_and_what_is_switched_on(live: Live) -> None:
    def is_on(name: str, expected: bool) -> bool:
        return live.overlays.on[name] == expected

    with page() as shown:
        shown.open(f"{live.url}/?fixedDpr=1")  # else it gets coarser where it is slow
        shown.wait("document.body?.innerText.includes('Feature graph')")
        shown.run("document.querySelector('.mantine-Notifications-root')?.remove()")
        plain = shown.settled()
        orange = np.abs(plain.astype(int) - (215, 135, 0)).max(axis=2) < 60  # robot 1
        assert orange.sum() > 50
        assert (plain[250:, :640].std(axis=(0, 1)) > 5).all()
        for name in Overlays.NAMES[3:]:
            click(shown, name.capitalize())
            until(partial(is_on, name, True))
            live.refresh()
            until(lambda: changed(shown, plain) > 50)
            click(shown, name.capitalize())
            until(partial(is_on, name, False))
            live.refresh()
            until(lambda: changed(shown, plain) < 20)
        assert shown.errors == []


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="chromium is not installed")
def test_in_a_browser_it_pauses_steps_and_follows(live: Live) -> None:
    simulator = live.simulator
    ended = threading.Event()

    def drive() -> None:
        while not ended.is_set():
            simulator.step(np.full((1, 4, simulator.action_size), 0.2))
            live.show()

    choose(live.panel._speed, "1x")
    thread = threading.Thread(target=drive, daemon=True)
    with page() as shown:
        shown.open(live.url)
        shown.wait("document.body?.innerText.includes('Feature graph')")
        until(lambda: bool(live.server.get_clients()))
        thread.start()
        press(shown, "Pause")
        until(lambda: not live.panel.running.is_set())
        time.sleep(0.5)
        held = int(simulator.steps[0])
        time.sleep(0.5)
        assert simulator.steps[0] == held
        press(shown, "Step")
        until(lambda: simulator.steps[0] == held + 1)
        choose(live.panel._follow, simulator.names[1])
        press(shown, "Play")
        until(lambda: simulator.steps[0] > held + 5)
        (client,) = live.server.get_clients().values()
        base = simulator.configurations[0, 1, :2]
        assert np.linalg.norm(client.camera.look_at[:2] - base) < 0.3
        assert shown.errors == []
        ended.set()
        live.panel.running.set()
        thread.join()


def changed(shown: Page, before: NDArray[np.uint8]) -> int:
    """Number of changed pixels left of the panel."""
    change = np.abs(shown.picture().astype(int) - before).max(axis=2)
    return int((change[:, :640] > 25).sum())


def press(shown: Page, label: str) -> None:
    """Press the button with that label."""
    shown.run(
        f"[...document.querySelectorAll('button')].find(b => b.innerText === '{label}').click()"
    )


def click(shown: Page, label: str) -> None:
    """Click the checkbox with that label."""
    script = (
        f"[...document.querySelectorAll('label')].find(l => l.innerText === '{label}')"
        ".closest('div:has(input)').querySelector('input').click()"
    )
    shown.run(script)


def choose(dropdown: Any, value: str) -> None:
    """Select a value of a dropdown, which viser declares read-only."""
    dropdown.value = value


def until(condition: Callable[[], bool]) -> None:
    """Wait until a condition holds."""
    end = time.monotonic() + 20
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.05)
