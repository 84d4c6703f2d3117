"""PPO of Ray RLlib: one policy for all robots, with samples from several workers.

Needs a separate Python environment, see requirements.txt. With `ray.init(address="auto")`
at the beginning the workers are those of a cluster.
"""

from typing import Any

from ray.rllib.algorithms.ppo import PPOConfig
from ray.rllib.core.rl_module.default_model_config import DefaultModelConfig
from ray.rllib.env.multi_agent_env import MultiAgentEnv

import fgenv
from fgenv.envs import Observation, Reward

N, ITERATIONS = 4, 20
WORLD = {"n": N, "jitter": 0.3, "on_collision": "pass", "max_cycles": 200}
PAID = {"progress": 1.0, "arrival": 5.0, "collision": -0.1}


class Fleet(MultiAgentEnv):  # type: ignore[misc]
    """A world of `swap`: robots leave when they arrive, and the episode ends with the last one."""

    def __init__(self, config: dict[str, Any]) -> None:
        super().__init__()
        seen = Observation(lidar=False, neighbors=3)
        self.env = fgenv.parallel_env("swap", observation=seen, reward=Reward(PAID), **config)
        self.agents = self.possible_agents = self.env.possible_agents
        self.observation_spaces = {a: self.env.observation_space(a) for a in self.agents}
        self.action_spaces = {a: self.env.action_space(a) for a in self.agents}

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
        return self.env.reset(seed)

    def step(self, action_dict: dict[str, Any]) -> Any:
        rows, rewards, ended, late, infos = self.env.step(action_dict)
        over = {"__all__": not self.env.agents}  # robots can arrive in the step of the time limit
        return rows, rewards, ended | over, late | over, infos


if __name__ == "__main__":
    network = DefaultModelConfig(fcnet_hiddens=[64, 64], vf_share_layers=False, free_log_std=True)
    config = PPOConfig().environment(Fleet, env_config=WORLD).debugging(seed=0)
    config.env_runners(num_env_runners=2, num_envs_per_env_runner=8)
    config.multi_agent(policies={"all"}, policy_mapping_fn=lambda agent, episode, **_: "all")
    config.rl_module(model_config=network)
    config.training(train_batch_size_per_learner=4000, minibatch_size=1024, num_epochs=5)
    config.training(lr=5e-4, lambda_=0.95, clip_param=0.2, grad_clip=0.5, use_kl_loss=False)
    algorithm, returns = config.build_algo(), []
    for k in range(ITERATIONS):
        found = algorithm.train()
        returns.append(found["env_runners"]["episode_return_mean"] / N)
        print(f"{k:3} return of a robot {returns[-1]:6.2f} after {found['time_total_s']:4.0f} s")
    algorithm.stop()
    assert max(returns[-5:]) > returns[0] + 3.0, "it has not learned"
