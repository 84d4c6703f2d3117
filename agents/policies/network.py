"""Trained networks as policies: native code without PyTorch, equal bits on every machine."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fgenv import _core
from fgenv.agents.policies.base import BasePolicy
from fgenv.agents.policies.policy_file import PolicyError, PolicyFile
from fgenv.agents.policies.residual import ResidualConfig, ResidualController
from fgenv.agents.weights import included
from fgenv.arrays import Floats, Floats32
from fgenv.envs import Observation, View
from fgenv.envs.observations import Part
from fgenv.scenarios.errors import near

Sizes = Sequence[tuple[str, int]]


class NetworkPolicy(BasePolicy):
    """Runs the network of a policy file; see `fgenv.agents.policies.policy_file`.

    Attributes:
        file: network and settings.
        observation: of the training; pass it to the `Simulator`.
        actions: of the training, `drive` or `way_points`; pass it as well.
    """

    def __init__(self, file: PolicyFile) -> None:
        self.file = file
        seen = self.observation = Observation(**file.about["observation"])
        blocks = 2 if seen.priority else 1
        self._neighbor = {flat: blocks * seen.neighbor_size(flat) for flat in (True, False)}
        self.actions: str = file.about["actions"]
        kinds = [file.about["activation"]] * (len(file.layers) - 1) + ["none"]
        layers = zip(file.layers, kinds, strict=True)
        self._network = _core.Network([(w, b, kind) for (w, b), kind in layers])
        self._clip = float(file.about["clip"])
        self._controller = ResidualController(ResidualConfig.of(file.about))

    @classmethod
    def load(cls, path: str | Path) -> NetworkPolicy:
        """Load a policy file.

        Raises:
            PolicyError: not a policy, damaged, or of another version.
            FileNotFoundError: no such file.
        """
        return cls(PolicyFile.load(path))

    def reset(self, view: View) -> None:
        """Begin new episodes.

        Raises:
            PolicyError: observations or actions differ from those of the training.
        """
        super().reset(view)
        self._controller.reset(view)
        expected = [(name, size) for name, size in self.file.about["parts"]]
        flat = all(robot.base == "planar" for robot in view.robots)
        others = self._neighbor[flat] * (view.n_robots - 1)
        self._slices = [
            matched_slices(expected, parts, view.names[i], others)
            for i, parts in enumerate(view.layouts)
        ]
        self._check_actions(view)

    def _check_actions(self, view: View) -> None:
        known = [name for name, *_ in self.file.about["action_names"]]
        for i, robot in enumerate(view.robots):
            names = [action.name for action in robot.actions]
            if names != known or view.actions != self.actions:
                raise PolicyError(
                    f"policy: {view.names[i]!r} acts by {', '.join(names)} ({view.actions}),"
                    f" expected {', '.join(known)} ({self.actions})"
                )

    def act(self, observations: Floats32) -> Floats:
        """Return actions (worlds, robots, size)."""
        file = self.file
        rows = np.zeros((*observations.shape[:2], len(file.mean)))
        for i, slices in enumerate(self._slices):
            for target, source in slices:
                rows[:, i, target] = observations[:, i, source]
        inputs = np.clip((rows - file.mean) / file.std, -self._clip, self._clip)
        return self._controller.actions(self._network.run(inputs, None), observations)


def matched_slices(
    expected: Sizes, parts: Sequence[Part], robot: str, others: int
) -> list[tuple[slice, slice]]:
    """Return slices of the network's input and the matching slices of a robot's observation.

    Args:
        others: size of the observation of all other robots.

    Raises:
        PolicyError: the observation does not fit the network.
    """
    available = {part.name: part.slice for part in parts}
    sizes = [(name, part.stop - part.start) for name, part in available.items()]
    slices, begin = [], 0
    for name, size in expected:
        source = available.pop(name, slice(0, 0))
        n = source.stop - source.start
        enough = n >= size or n == others  # at least as many as in training, or all robots
        if not enough if name == "neighbors" else n != size:
            raise observation_error(expected, sizes, robot)
        n = min(n, size)
        slices.append((slice(begin, begin + n), slice(source.start, source.start + n)))
        begin += size
    if available.keys() - {"neighbors"}:
        raise observation_error(expected, sizes, robot)
    return slices


def observation_error(expected: Sizes, sizes: Sizes, robot: str) -> PolicyError:
    """Return the error for an observation with other parts than expected."""
    here, there = (", ".join(f"{part} ({n})" for part, n in row) for row in (sizes, expected))
    return PolicyError(
        f"policy: {robot!r} observes {here}, expected {there} (numbers of each); give the simulator"
        " the policy's observation"
    )


def mlp(argument: str, seed: int) -> NetworkPolicy:
    """Make the policy named `mlp:FILE`, or `mlp:NAME` of an included network."""
    files = included()
    if not argument:
        names = ", ".join(f"mlp:{name}" for name in files)
        raise ValueError(f"policy: got 'mlp:', expected mlp:FILE or an included policy: {names}")
    if argument not in files and not Path(argument).suffix:
        raise ValueError(
            f"policy: got 'mlp:{argument}', which is no included policy; {near(argument, files)}"
            " (a file ends in .npz)"
        )
    return NetworkPolicy.load(files.get(argument, argument))
