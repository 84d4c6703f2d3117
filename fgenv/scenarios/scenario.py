"""`Scenario`: loaded from a file or by name, checked, saved, and built into robots and arrays."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from fgenv.collision import World

from .build import Built
from .errors import Problem
from .load import load
from .schema import ScenarioSpec
from .validation import problems
from .yaml_io import write


class Scenario(ScenarioSpec):
    """Robots with starts and goals among bodies; immutable.

    `Scenario.load` reads a file or generates a built-in scenario, `build` makes robots and arrays,
    `world` a `World` with all bodies, and `problems` lists the faults.
    """

    def __repr__(self) -> str:
        counts = f"{len(self.robots)} robots, {len(self.bodies)} bodies, seed {self.seed}"
        return f"Scenario({self.name!r}: {counts})"

    __str__ = __repr__

    @classmethod
    def load(cls, source: str | Path, **overrides: Any) -> Scenario:
        """Load a scenario from a YAML file, or a built-in scenario by name.

        Args:
            source: a path (with the suffix .yaml or .yml, or with a folder), or a name.
            overrides: parameters of the built-in scenario (n, seed, size, ...), and plain fields of
                the schema: seed, time_step, horizon, on_collision, at_goal, description.

        Raises:
            ScenarioError: all problems of the file by line; or an unknown name or override.
            FileNotFoundError: no such file.
        """
        return load(cls, source, overrides)

    def save(self, path: str | Path) -> None:
        """Write YAML, without the fields that have their defaults.

        Mesh and URDF files are not copied; their paths are written relative to the new file.
        """
        write(self, Path(path))

    def build(self) -> Built:
        """Robots, starts, goals, shapes and poses as plain arrays."""
        return Built.of(self)

    def world(self) -> World:
        """A world of all bodies, the robots at their starts; see `Built.world`."""
        return self.build().world()

    def problems(self) -> tuple[Problem, ...]:
        """All faults of files, limits and placements; empty for a valid scenario."""
        return tuple(problems(self))
