"""A trained network as a policy: in native code, without PyTorch, to the same bits everywhere."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from fgenv import _core
from fgenv.agents.policies.base_action import Acting, BaseAction
from fgenv.agents.policies.file import PolicyError, PolicyFile
from fgenv.agents.policies.observation import Seeing
from fgenv.arrays import Floats, Floats32
from fgenv.envs import Observation, View
from fgenv.envs.observations import Part


class Trained(Seeing):
    """Acts as the network of a file says; see `fgenv.agents.policies.file`.

    Attributes:
        file: with all that is known about it.
        observation: what it was trained with; give it to the `Simulator`.
        actions: `drive` or `way_points`; the same.
    """

    def __init__(self, file: PolicyFile) -> None:
        self.file = file
        seen = self.observation = Observation(**file.about["observation"])
        many = 2 if seen.priority else 1
        self._neighbor = {flat: many * seen.neighbor_size(flat) for flat in (True, False)}
        self.actions: str = file.about["actions"]
        kinds = [file.about["activation"]] * (len(file.layers) - 1) + ["none"]
        layers = zip(file.layers, kinds, strict=True)
        self._network = _core.Network([(w, b, kind) for (w, b), kind in layers])
        self._clip = float(file.about["clip"])
        self._acting = Acting(BaseAction.of(file.about))

    @classmethod
    def load(cls, path: str | Path) -> Trained:
        """From a file.

        Raises:
            PolicyError: no policy, damaged, or of another version.
            FileNotFoundError: no such file.
        """
        return cls(PolicyFile.load(path))

    def reset(self, view: View) -> None:
        """Episodes begin.

        Raises:
            PolicyError: the robots observe or act otherwise than those that it was trained on.
        """
        super().reset(view)
        self._acting.reset(view)
        about = self.file.about
        expected = [(name, size) for name, size in about["parts"]]
        flat = all(robot.base == "planar" for robot in view.robots)
        others = self._neighbor[flat] * (view.n_robots - 1)
        self._slices = [
            fitted(expected, parts, view.names[i], others) for i, parts in enumerate(view.layouts)
        ]
        for i, robot in enumerate(view.robots):
            names = [action.name for action in robot.actions]
            known = [name for name, *_ in about["action_names"]]
            if names != known or view.actions != self.actions:
                raise PolicyError(
                    f"policy: {view.names[i]!r} acts by {', '.join(names)} ({view.actions}),"
                    f" expected {', '.join(known)} ({self.actions})"
                )

    def act(self, observations: Floats32) -> Floats:
        """Actions (worlds, robots, size)."""
        file = self.file
        rows = np.zeros((*observations.shape[:2], len(file.mean)))
        for i, slices in enumerate(self._slices):
            for into, of in slices:
                rows[:, i, into] = observations[:, i, of]
        seen = np.clip((rows - file.mean) / file.std, -self._clip, self._clip)
        return self._acting.actions(self._network.run(seen, None), observations)


def fitted(
    expected: Sequence[tuple[str, int]], parts: Sequence[Part], robot: str, others: int
) -> list[tuple[slice, slice]]:
    """Where a robot's row goes in the network's: pairs of slices.

    Args:
        others: numbers of all other robots there are.

    Raises:
        PolicyError: it does not fit.
    """
    there = {part.name: part.slice for part in parts}
    sizes = [(name, part.stop - part.start) for name, part in there.items()]
    found, begin = [], 0
    for name, size in expected:
        of = there.pop(name, slice(0, 0))
        n = of.stop - of.start
        enough = n >= size or n == others  # more than it wants, or all that there are
        if not enough if name == "neighbors" else n != size:
            raise unfit(expected, sizes, robot)
        n = min(n, size)
        found.append((slice(begin, begin + n), slice(of.start, of.start + n)))
        begin += size
    if there.keys() - {"neighbors"}:
        raise unfit(expected, sizes, robot)
    return found


def unfit(
    expected: Sequence[tuple[str, int]], sizes: Sequence[tuple[str, int]], name: str
) -> PolicyError:
    """What is told where they differ."""
    here, there = (", ".join(f"{part} ({n})" for part, n in row) for row in (sizes, expected))
    return PolicyError(
        f"policy: {name!r} observes {here}, expected {there} (numbers of each); give the simulator"
        " the policy's observation"
    )
