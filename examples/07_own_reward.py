"""A reward of your own: a plain NumPy function over all worlds and robots at once."""

import numpy as np
from numpy.typing import NDArray

from fgenv.envs import Observation, Reward, Simulator


def crowding(simulator: Simulator) -> NDArray[np.float64]:
    """Return the number of robots within a meter, (worlds, robots)."""
    place = simulator.configurations[..., :2]
    apart = np.linalg.norm(place[:, :, None] - place[:, None, :], axis=-1)
    return np.asarray((apart < 1.0).sum(axis=-1) - 1.0)


reward = Reward({"progress": 1.0, "collision": -1.0}, own=((crowding, -0.1),))
simulator = Simulator(
    "swap", worlds=16, n=12, size=6.0, reward=reward, observation=Observation(lidar=False)
)
simulator.reset(seed=0)
total = np.zeros((16, 12))
for _ in range(50):
    step = simulator.step(simulator.toward(simulator.goals))
    total += step.rewards
print(f"{total.mean():.2f} a robot; {simulator.collision_counts.mean():.1f} steps in contact each")
crowded = crowding(simulator)
print(f"in the end a robot has {crowded.mean():.1f} others within a meter")
assert np.ptp(total, axis=0).max() == 0.0  # all worlds are equal: nothing is random
