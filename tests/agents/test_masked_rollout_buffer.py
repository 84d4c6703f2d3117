"""The rollout buffer samples steps of moving robots only."""

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
    """Environments in which robot 0 of each world is almost at its goal."""
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
    """Return a buffer of steps in which only robots near their goals move, and the moving rows."""
    found = MaskedRolloutBuffer(
        steps, envs.observation_space, envs.action_space, "cpu", 0.9, 0.8, envs.num_envs
    )
    found.envs = envs
    moved = []
    for k in range(steps):
        moved.append(envs.moving)
        rows, rewards, dones, _ = envs.step(np.zeros((envs.num_envs, 2)))
        assert isinstance(rows, np.ndarray)
        numbers = np.arange(envs.num_envs) + 100.0 * k
        rows = np.repeat(numbers[:, None], rows.shape[1], axis=1)
        ones = torch.ones(envs.num_envs)
        found.add(rows, np.zeros((envs.num_envs, 2)), rewards, np.zeros_like(dones), ones, ones)
    found.compute_returns_and_advantage(torch.ones(envs.num_envs), dones)
    return found, np.array(moved)


def test_batches_have_moving_rows_only(envs: MultiScenarioVecEnv) -> None:
    rollouts, moved = filled(envs, 4)
    assert moved[0].all()
    assert (~moved[1:]).sum() == 4 * 3  # robot 0 of four worlds, in three steps
    expected = [100 * k + row for k, row in np.argwhere(moved)]
    for size, many in ((None, len(expected)), (7, len(expected) // 7 * 7)):
        batches = [batch.observations[:, 0] for batch in rollouts.get(size)]
        seen = torch.cat(batches).tolist()
        assert len(seen) == len(set(seen)) == many
        assert set(seen) <= set(expected)


def test_values_after_arrival_are_zero(envs: MultiScenarioVecEnv) -> None:
    rollouts, moved = filled(envs, 4)
    arrived = ~moved[1]
    # The only reward is that of the arrival step.
    assert rollouts.returns[0, arrived] == pytest.approx(rollouts.rewards[0, arrived])
    assert (rollouts.returns[1:, arrived] == 0).all()
    assert (rollouts.rewards[0, arrived] > 5).all()
    on_the_way = rollouts.returns[:, ~arrived]
    expected = np.ones(on_the_way.shape[1])  # the values after the last step are 1
    for k in reversed(range(4)):
        later = 0.1 * 1.0 + 0.9 * expected if k < 3 else expected
        expected = rollouts.rewards[k, ~arrived] + 0.8 * later
        np.testing.assert_allclose(on_the_way[k], expected, rtol=1e-5)
