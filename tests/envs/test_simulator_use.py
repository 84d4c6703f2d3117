"""Wrong use of the simulator raises an error and changes nothing."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from fgenv.agents import GoToPolicy, run_episode
from fgenv.envs import Observation, Simulator

Q, TWO = [0.0, 0.0, 0.0], np.zeros((1, 2, 3))


@pytest.mark.parametrize(
    ("method", "use"),
    [
        ("step", lambda s: s.step(np.zeros((1, 2, 2)))),
        ("observe", lambda s: s.observe()),
        ("toward", lambda s: s.toward(TWO)),
        ("place", lambda s: s.place(0, 0, Q, Q)),
        ("set_path", lambda s: s.set_path(0, 0, [Q])),
        ("state", lambda s: s.state()),
    ],
)
def test_before_the_first_reset_is_an_error(method: str, use: Callable[[Simulator], Any]) -> None:
    with pytest.raises(RuntimeError, match=f"{method}: before the first reset, call reset"):
        use(Simulator("swap", n=2))


@pytest.mark.parametrize(
    "use",
    [
        lambda s: s.step(np.full((1, 2, 2), np.nan)),
        lambda s: s.step(np.zeros((1, 3, 2))),
        lambda s: s.step(None),
        lambda s: s.toward(np.zeros((1, 2, 4))),
        lambda s: s.place(0, 5, Q, Q),
        lambda s: s.place(0, 0, Q, [0.0, np.inf, 0.0]),
        lambda s: s.set_path(0, 0, np.empty((0, 3))),
        lambda s: s.reset(seed=-1),
        lambda s: s.reset(worlds=[1]),
        lambda s: s.world(1),
        lambda s: s.collisions(-1),
    ],
)
def test_invalid_input_raises_and_changes_nothing(use: Callable[[Simulator], Any]) -> None:
    simulator = Simulator("swap", n=2, autoreset=False)
    simulator.reset(seed=0)
    simulator.step(np.ones((1, 2, 2)))
    before = simulator.state()
    with pytest.raises((ValueError, TypeError), match=r"^[a-z]+(\[.*\])?:? "):
        use(simulator)
    assert simulator.state() == before
    simulator.step(np.ones((1, 2, 2)))


@pytest.mark.parametrize(
    "options", [{"on_collision": "pass"}, {"on_collision": "terminate"}, {"horizon": 0.5}]
)
def test_steps_after_the_end_raise_for_a_restored_state(options: dict[str, Any]) -> None:
    simulator = Simulator("swap", n=2, autoreset=False, **options)
    run_episode(simulator, GoToPolicy())
    other = Simulator("swap", n=2, autoreset=False, **options)
    other.set_state(simulator.state())
    for ended in (simulator, other):
        before = ended.state()
        with pytest.raises(RuntimeError, match="the episode of world 0 is over, call reset"):
            ended.step(np.zeros((1, 2, 2)))
        assert ended.state() == before
        ended.reset()
        ended.step(np.zeros((1, 2, 2)))


def test_resetting_no_world_changes_nothing() -> None:
    simulator = Simulator("swap", 3, n=2)
    assert simulator.reset(worlds=[], seed=4).shape == (0, 2, simulator.observation_size)
    assert simulator.seeds.tolist() == [0, 1, 2]


def test_an_empty_observation_raises() -> None:
    blind = Observation(goal=False, velocity=False, lidar=False)
    with pytest.raises(ValueError, match="observation: got no part for 'robot 1'"):
        Simulator("swap", n=1, observation=blind)
    assert Simulator("swap", n=2, observation=blind).reset(seed=0).shape == (1, 2, 7)


@pytest.mark.parametrize("name", ["observation", "reward"])
def test_settings_of_a_wrong_type_raise(name: str) -> None:
    with pytest.raises(TypeError, match=rf"{name}: got 3, expected fgenv\.envs\.{name.title()}"):
        Simulator("swap", **{name: 3})  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="way_point_seconds: got 'a'"):
        Simulator("swap", way_point_seconds="a")  # type: ignore[arg-type]
