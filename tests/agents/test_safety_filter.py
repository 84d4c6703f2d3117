"""The safety filter, and the look ahead that it has from its view."""

import numpy as np
import pytest

from fgenv.envs import Simulator, View, policy_of


def collisions(name: str, policy: str, **options: object) -> int:
    """Robot steps in contact of six worlds in 60 steps."""
    simulator = Simulator(name, 6, starts="random", autoreset=False, **options)
    rows, acting = simulator.reset(seed=3), policy_of(policy, 1)
    acting.reset(View(simulator))
    for _ in range(60):
        step = simulator.step(acting.act(rows))
        rows, over = step.observations, step.terminated | step.truncated
        if over.any():
            break
    return int(simulator.collision_counts.sum())


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("swap", {"n": 8, "drive": "holonomic"}),
        ("swap", {"n": 6, "body": "long"}),
        ("swap", {"n": 6, "body": "l"}),
        ("doorway", {"n": 8}),
        ("random", {"n": 8, "actions": "way_points"}),
    ],
)
@pytest.mark.parametrize("policy", ["goto", "random"])
def test_nobody_meets_anything_behind_the_filter(name: str, options: dict, policy: str) -> None:
    assert collisions(name, policy, **options) > 0
    assert collisions(name, f"safe:{policy}", **options) == 0


def test_who_cannot_stop_in_a_step_brakes_at_least() -> None:
    assert 0 < collisions("forest", "safe:goto", n=4) < collisions("forest", "goto", n=4)


def test_what_the_view_foresees_is_what_happens() -> None:
    simulator = Simulator("doorway", 5, n=6, starts="random")
    simulator.reset(seed=0)
    view, rng, seen = View(simulator), np.random.default_rng(0), 0
    for _ in range(80):
        actions, before = simulator.sample(rng), simulator.state()
        foreseen = view.meet(actions)
        assert simulator.state() == before
        simulator.step(actions)
        assert (foreseen == (simulator.hits >= 0)).all()
        seen += int(foreseen.sum())
    assert seen > 10


def test_a_filter_takes_what_its_policy_observes() -> None:
    inner, outer = policy_of("mlp:swap-holonomic"), policy_of("safe:mlp:swap-holonomic")
    assert outer.observation == inner.observation
    assert outer.actions == "drive"


def test_a_filter_of_nothing_is_told() -> None:
    with pytest.raises(ValueError, match="policy: got 'nobody', which is unknown"):
        policy_of("safe:nobody")
