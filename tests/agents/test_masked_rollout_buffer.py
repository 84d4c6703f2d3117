"""What PPO learns from: the steps of robots on the way, and nothing of who rests."""

from __future__ import annotations

import numpy as np
import pytest

pytest.importorskip("stable_baselines3")

import torch

from fgenv.agents.training.masked_rollout_buffer import MaskedRolloutBuffer
from fgenv.agents.training.multi_scenario import MultiScenarioVecEnv
from fgenv.agents.training.residual_vec_env import ResidualVecEnv
from fgenv.envs import Observation

QUIET = Observation(lidar=False, neighbors=2, pad=True)


@pytest.fixture
def envs() -> MultiScenarioVecEnv:
    """Rows of which robot 0 of each world is all but there."""
    parts = [ResidualVecEnv("swap", 2, n=n, observation=QUIET) for n in (2, 3)]
    made = MultiScenarioVecEnv(parts)
    made.reset()
    for part in parts:
        simulator = part.simulator
        for world in range(2):
            start = simulator.configurations[world, 0]
            simulator.place(world, 0, start + [0.0, 0.0, 0.0], start)
    return made


def filled(envs: MultiScenarioVecEnv, steps: int) -> tuple[MaskedRolloutBuffer, np.ndarray]:
    """A buffer of so many steps of nobody but who is there moving, and who was on the way."""
    found = MaskedRolloutBuffer(
        steps, envs.observation_space, envs.action_space, "cpu", 0.9, 0.8, envs.num_envs
    )
    found.envs = envs
    moved = []
    for k in range(steps):
        moved.append(envs.moving)
        rows, rewards, dones, _ = envs.step(np.zeros((envs.num_envs, 2)))
        numbers = np.arange(envs.num_envs) + 100.0 * k
        rows = np.repeat(numbers[:, None], rows.shape[1], axis=1)
        ones = torch.ones(envs.num_envs)
        found.add(rows, np.zeros((envs.num_envs, 2)), rewards, np.zeros_like(dones), ones, ones)
    found.compute_returns_and_advantage(torch.ones(envs.num_envs), dones)
    return found, np.array(moved)


def test_batches_are_of_who_was_on_the_way(envs: MultiScenarioVecEnv) -> None:
    rollouts, moved = filled(envs, 4)
    assert moved[0].all()
    assert (~moved[1:]).sum() == 4 * 3  # robot 0 of four worlds, for three steps
    expected = [100 * k + row for k, row in np.argwhere(moved)]
    for size, many in ((None, len(expected)), (7, len(expected) // 7 * 7)):
        batches = [batch.observations[:, 0] for batch in rollouts.get(size)]
        seen = torch.cat(batches).tolist()
        assert len(seen) == len(set(seen)) == many
        assert set(seen) <= set(expected)


def test_who_has_arrived_is_worth_nothing_more(envs: MultiScenarioVecEnv) -> None:
    rollouts, moved = filled(envs, 4)
    arrived = ~moved[1]
    # All that comes is the reward of the step in which it arrived.
    assert rollouts.returns[0, arrived] == pytest.approx(rollouts.rewards[0, arrived])
    assert (rollouts.returns[1:, arrived] == 0).all()
    assert (rollouts.rewards[0, arrived] > 5).all()
    on_the_way = rollouts.returns[:, ~arrived]
    expected = np.ones(on_the_way.shape[1])  # the values beyond the end are 1 all the same
    for k in reversed(range(4)):
        later = 0.1 * 1.0 + 0.9 * expected if k < 3 else expected
        expected = rollouts.rewards[k, ~arrived] + 0.8 * later
        np.testing.assert_allclose(on_the_way[k], expected, rtol=1e-5)
