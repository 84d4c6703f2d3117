"""fgenv in ``fgenv bench env``: scenes, and batches of its simulator and views."""

from __future__ import annotations

from importlib.util import find_spec

import numpy as np

from fgenv.bench.env.batch import ACTIONS, Batch, parallel_batch
from fgenv.envs import Simulator, parallel_env
from fgenv.scenarios import Scenario

RAYS = 12
VEC_ENV_WORLDS = 32
# 268 triangles, within the circle of the disc that it replaces.
CART = {"kind": "cart", "length": 0.5, "width": 0.32, "height": 0.25}


def random_scene(robots: int, seed: int) -> Scenario:
    """Return `random`, about 10 m² per robot: carts among clutter, with lidars of 12 rays."""
    scene = Scenario.load("random", n=robots, seed=seed)
    return with_rays(scene.replace(shapes={**scene.shapes, "disc": CART}))


def warehouse_scene(robots: int, seed: int) -> Scenario:
    """Return `warehouse`: carts of 268 triangles among racks, with lidars of 12 rays."""
    return with_rays(Scenario.load("warehouse", n=robots, seed=seed))


def with_rays(scene: Scenario, rays: int = RAYS) -> Scenario:
    """Return the scene with a number of rays in the lidars of all its models."""
    models = {
        name: model.model_copy(
            update={"lidar": model.lidar and model.lidar.model_copy(update={"rays": rays})}
        )
        for name, model in scene.models.items()
    }
    return scene.replace(models=models)


def simulator(scene: Scenario, worlds: int) -> Simulator:
    """Return the batched simulator on one thread."""
    return Simulator(scene, worlds, threads=1)


def simulator_batch(scene: Scenario, worlds: int, seed: int) -> Batch:
    """Return the simulator as a batch; its episodes restart inside, which is timed."""
    sim = simulator(scene, worlds)
    sim.reset(seed=seed)
    shape = (ACTIONS, worlds, sim.n_robots, sim.action_size)
    actions = np.random.default_rng(seed).uniform(-1.0, 1.0, shape)
    return Batch(sim.n_robots, worlds, lambda k: sim.step(actions[k % ACTIONS]))


def random_batch(robots: int, worlds: int, seed: int) -> Batch:
    """Return the batch that is compared with the other libraries."""
    return simulator_batch(random_scene(robots, seed), worlds, seed)


def warehouse_batch(robots: int, worlds: int, seed: int) -> Batch:
    """Return carts in a warehouse."""
    return simulator_batch(warehouse_scene(robots, seed), worlds, seed)


def views(robots: int, seed: int) -> dict[str, tuple[Batch, Batch]]:
    """Return views of the simulator by name, each with the simulator below it: (view, simulator).

    Their difference is the cost of the view's Python code. PettingZoo steps one world; the VecEnv,
    included if Stable-Baselines3 is installed, steps 32.
    """
    scene = random_scene(robots, seed)
    env = parallel_batch(parallel_env(scene, threads=1), seed)
    pairs = {"PettingZoo": (env, simulator_batch(scene, 1, seed))}
    if find_spec("stable_baselines3") is not None:
        pairs["SB3 VecEnv"] = (
            vec_env_batch(scene, VEC_ENV_WORLDS, seed),
            simulator_batch(scene, VEC_ENV_WORLDS, seed),
        )
    return pairs


def vec_env_batch(scene: Scenario, worlds: int, seed: int) -> Batch:
    """Return the Stable-Baselines3 view as a batch."""
    from fgenv.agents import FleetVecEnv

    envs = FleetVecEnv(scene, worlds, threads=1)
    envs.seed(seed)
    envs.reset()
    shape = (ACTIONS, envs.num_envs, *(envs.action_space.shape or ()))
    actions = np.random.default_rng(seed).uniform(-1.0, 1.0, shape).astype(np.float32)
    return Batch(envs.num_envs // worlds, worlds, lambda k: envs.step(actions[k % ACTIONS]))
