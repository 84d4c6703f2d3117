"""fgenv's side of the race: which scenes, and how its simulator and its views are stepped."""

from __future__ import annotations

from importlib.util import find_spec

import numpy as np

from fgenv.bench.env.batch import ACTIONS, Batch
from fgenv.bench.env.parallel import parallel_batch
from fgenv.envs import Simulator, parallel_env
from fgenv.scenarios import Scenario

RAYS = 12
ROWS_WORLDS = 32
# Within the circle of the disc that it stands for, and of 268 triangles.
CART = {"kind": "cart", "length": 0.5, "width": 0.32, "height": 0.25}


def random_scene(robots: int, seed: int) -> Scenario:
    """`random`, about 10 m² a robot: carts among clutter, with lidars of 12 rays."""
    scene = Scenario.load("random", n=robots, seed=seed)
    return with_rays(scene.replace(shapes={**scene.shapes, "disc": CART}))


def warehouse_scene(robots: int, seed: int) -> Scenario:
    """`warehouse`: carts of 268 triangles among racks, with lidars of 12 rays."""
    return with_rays(Scenario.load("warehouse", n=robots, seed=seed))


def with_rays(scene: Scenario, rays: int = RAYS) -> Scenario:
    """The scene, the lidars of all its models with so many rays."""
    models = {
        name: model.model_copy(
            update={"lidar": model.lidar and model.lidar.model_copy(update={"rays": rays})}
        )
        for name, model in scene.models.items()
    }
    return scene.replace(models=models)


def simulator(scene: Scenario, worlds: int) -> Simulator:
    """The batched simulator on one thread."""
    return Simulator(scene, worlds, threads=1)


def simulator_batch(scene: Scenario, worlds: int, seed: int) -> Batch:
    """Step the simulator from NumPy arrays; its episodes start anew inside, which is timed."""
    sim = simulator(scene, worlds)
    sim.reset(seed=seed)
    shape = (ACTIONS, worlds, sim.n_robots, sim.action_size)
    drawn = np.random.default_rng(seed).uniform(-1.0, 1.0, shape)
    return Batch(sim.n_robots, worlds, lambda k: sim.step(drawn[k % ACTIONS]))


def random_batch(robots: int, worlds: int, seed: int) -> Batch:
    """What races the other libraries."""
    return simulator_batch(random_scene(robots, seed), worlds, seed)


def warehouse_batch(robots: int, worlds: int, seed: int) -> Batch:
    """Many carts in a warehouse."""
    return simulator_batch(warehouse_scene(robots, seed), worlds, seed)


def views(robots: int, seed: int) -> dict[str, tuple[Batch, Batch]]:
    """Views of the simulator by name, each with the simulator below it: (view, simulator).

    Their difference is what the view's Python costs. PettingZoo steps one world; the VecEnv, where
    Stable-Baselines3 is installed, 32.
    """
    scene = random_scene(robots, seed)
    env = parallel_batch(parallel_env(scene, threads=1), seed)
    found = {"PettingZoo": (env, simulator_batch(scene, 1, seed))}
    if find_spec("stable_baselines3") is not None:
        found["SB3 VecEnv"] = (
            rows_batch(scene, ROWS_WORLDS, seed),
            simulator_batch(scene, ROWS_WORLDS, seed),
        )
    return found


def rows_batch(scene: Scenario, worlds: int, seed: int) -> Batch:
    """Step the Stable-Baselines3 view."""
    from fgenv.agents import FleetVecEnv

    envs = FleetVecEnv(scene, worlds, threads=1)
    envs.seed(seed)
    envs.reset()
    shape = (ACTIONS, envs.num_envs, *(envs.action_space.shape or ()))
    drawn = np.random.default_rng(seed).uniform(-1.0, 1.0, shape).astype(np.float32)
    return Batch(envs.num_envs // worlds, worlds, lambda k: envs.step(drawn[k % ACTIONS]))
