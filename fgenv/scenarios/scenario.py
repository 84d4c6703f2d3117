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

    @classmethod
    def load(cls, source: str | Path, **overrides: Any) -> Scenario:
        """A scenario from a YAML file, or a built-in one by its name.

        Args:
            source: path (it ends in .yaml or .yml, or has a folder) or name.
            overrides: for a built-in one, what it takes (n, seed, size and its own); for all,
                fields of the schema that are plain: seed, time_step, horizon, on_collision...

        Raises:
            ScenarioError: all that is wrong, by line; or a name or override that is not known.
            FileNotFoundError: no such file.
        """
        return load(cls, source, overrides)

    def save(self, path: str | Path) -> None:
        """Write YAML; what has its default is left out.

        Mesh and URDF files stay where they are; their paths are written from the new place.
        """
        write(self, Path(path))

    def build(self) -> Built:
        """Robots, starts, goals, shapes and poses as plain arrays."""
        return Built.of(self)

    def world(self) -> World:
        """A world of all bodies, the robots at their starts; see `Built.world`."""
        return self.build().world()

    def problems(self) -> tuple[Problem, ...]:
        """All that is wrong with files, limits and places; empty for a sound scenario."""
        return tuple(problems(self))
