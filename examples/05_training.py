"""A training loop of ten lines (cross-entropy method): each world evaluates its own policy."""

import numpy as np

from fgenv.envs import FleetVectorEnv, Observation, Reward  # or gymnasium.make_vec("fgenv/swap-v0")

seen = Observation(lidar=False, velocity=False, neighbors=1)  # the goal, and the other robot
paid = Reward({"progress": 1.0, "arrival": 5.0, "collision": -0.05})
worlds = FleetVectorEnv(
    "swap", num_envs=64, n=2, others="goto", starts="random", observation=seen, reward=paid
)
rng, history = np.random.default_rng(0), []
mean, spread = np.zeros((2, 11)), np.ones((2, 11))

for generation in range(20):
    policies = mean + spread * rng.standard_normal((64, 2, 11))
    rows, _ = worlds.reset(seed=[generation] * 64)  # the same start in all worlds
    gained = np.zeros(64)
    for _step in range(60):  # six seconds
        actions = np.tanh(np.einsum("wao,wo->wa", policies, rows)).astype(np.float32)
        step = worlds.step(actions)
        rows, gained = step[0], gained + step[1]
    best = policies[np.argsort(gained)[-12:]]
    mean, spread = best.mean(axis=0), best.std(axis=0) + 0.02
    history.append(gained.mean())
    print(f"generation {generation}: {gained.mean():6.2f} gained in the mean")

assert np.mean(history[-5:]) > np.mean(history[:5]) + 0.5, "it has not learned"
