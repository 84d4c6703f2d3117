"""The safety filter, and the prediction by its view."""

from typing import Any

import numpy as np
import pytest

from fgenv.agents.policies.network import NetworkPolicy
from fgenv.agents.policies.safety_filter import SafetyFilter
from fgenv.envs import Simulator, View, policy_of


def collisions(name: str, policy: str, **options: Any) -> int:
    """Return the number of robot steps in contact in six worlds over 60 steps."""
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
def test_filtered_policies_have_no_collisions(
    name: str, options: dict[str, Any], policy: str
) -> None:
    assert collisions(name, policy, **options) > 0
    assert collisions(name, f"safe:{policy}", **options) == 0


def test_drives_with_an_acceleration_limit_have_fewer_collisions() -> None:
    assert 0 < collisions("forest", "safe:goto", n=4) < collisions("forest", "goto", n=4)


def test_the_view_predicts_the_collisions_of_a_step() -> None:
    simulator = Simulator("doorway", 5, n=6, starts="random")
    simulator.reset(seed=0)
    view, rng, seen = View(simulator), np.random.default_rng(0), 0
    for _ in range(80):
        actions, before = simulator.sample(rng), simulator.state()
        foreseen = view.would_collide(actions)
        assert simulator.state() == before
        simulator.step(actions)
        assert (foreseen == (simulator.hits >= 0)).all()
        seen += int(foreseen.sum())
    assert seen > 10


def test_a_filter_has_the_observation_of_its_policy() -> None:
    inner, outer = policy_of("mlp:swap-holonomic"), policy_of("safe:mlp:swap-holonomic")
    assert isinstance(inner, NetworkPolicy)
    assert isinstance(outer, SafetyFilter)
    assert outer.observation == inner.observation
    assert outer.actions == "drive"


def test_a_filter_of_an_unknown_policy_raises() -> None:
    with pytest.raises(ValueError, match="policy: got 'unknown', which is unknown"):
        policy_of("safe:unknown")
