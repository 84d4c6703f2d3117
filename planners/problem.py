"""A scenario as a planner takes it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from fgenv import _core
from fgenv.arrays import Floats
from fgenv.collision import World
from fgenv.collision.world import TOLERANCE
from fgenv.robots import Robot
from fgenv.scenarios import Built, Scenario
from fgenv.scenarios.library import ENTRIES

from .errors import PlanningError


@dataclass(frozen=True, eq=False)
class Problem:
    """Robots that have to get from their starts to their goals.

    Attributes:
        built: of the scenario.
        world: of all bodies, the robots at their starts.
        margin: meters that robots keep from everything, and from each other.
        seed: of all that is random.
    """

    built: Built
    world: World
    margin: float = 0.0
    seed: int = 0

    @classmethod
    def of(
        cls,
        scenario: str | Path | Scenario | Problem,
        margin: float = 0.0,
        seed: int = 0,
        **overrides: Any,
    ) -> Problem:
        """From a scenario, its name or its file; a Problem is what it is.

        Args:
            seed: of a built-in scenario too, if that is given by its name.
            overrides: for `Scenario.load`.
        """
        if isinstance(scenario, Problem):
            if overrides or margin not in (0.0, scenario.margin) or seed not in (0, scenario.seed):
                raise ValueError(
                    "margin, seed, overrides: a Problem has its own, expected Problem.of(scenario,"
                    " margin, seed)"
                )
            return scenario
        if not np.isfinite(margin) or margin < 0:
            raise ValueError(f"margin: got {margin}, expected meters, 0 or more")
        if seed < 0:
            raise ValueError(f"seed: got {seed}, expected 0 or more")
        if isinstance(scenario, str) and scenario in ENTRIES:
            overrides.setdefault("seed", seed)
        if not isinstance(scenario, Scenario):
            scenario = Scenario.load(scenario, **overrides)
        if not scenario.robots:
            raise ValueError(f"scenario: {scenario.name!r} has no robots, expected one at least")
        built = scenario.build()
        return cls(built, built.world(), float(margin), int(seed))

    @property
    def scenario(self) -> Scenario:
        """Where it comes from."""
        return self.built.scenario

    @property
    def models(self) -> tuple[Robot, ...]:
        """The robots' models."""
        return self.built.robots

    @property
    def starts(self) -> tuple[Floats, ...]:
        """Configurations, (nq,) each."""
        return self.built.starts

    @property
    def goals(self) -> tuple[Floats, ...]:
        """Configurations, (nq,) each."""
        return self.built.goals

    @property
    def dt(self) -> float:
        """Seconds of a step."""
        return self.scenario.time_step

    @property
    def vanish(self) -> bool:
        """Whether a robot at its goal is gone, rather than an obstacle."""
        return self.scenario.at_goal == "vanish"

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Of the robots."""
        return tuple(groups[0] for groups in self.built.groups)

    @cached_property
    def robots(self) -> tuple[int, ...]:
        """Ids in `world`."""
        names = dict(zip(self.world.names, self.world.ids.tolist(), strict=True))
        return tuple(self._id(names, i) for i in range(len(self.names)))

    def _id(self, names: dict[str, int], i: int) -> int:
        name = self.names[i]
        return names[name] if name in names else int(self.world.parts(name)[0])

    @cached_property
    def kinds(self) -> tuple[int, ...]:
        """Equal for robots that can be taken for each other: they share roadmaps."""
        known: dict[Any, int] = {}
        named = {name for pair in self.scenario.allowed for name in pair}
        keys = [
            (s.model, s.mount.pose.tobytes(), s.groups, s.name if s.name in named else "")
            for s in self.scenario.robots
        ]
        return tuple(known.setdefault(key, len(known)) for key in keys)

    def alone(self, *which: int) -> World:
        """A world of the bodies that stand and these robots."""
        world = self.built.world(robots=False)
        for i in which:
            self.built.add_robot(world, i, self.starts[i])
        return world

    def index(self, robot: int | str) -> int:
        """Place of a robot, by its name or place.

        Raises:
            ValueError: there is none.
        """
        if isinstance(robot, str):
            if robot not in self.names:
                raise ValueError(f"robot: got {robot!r}, expected one of {', '.join(self.names)}")
            return self.names.index(robot)
        if not 0 <= robot < len(self.names):
            raise ValueError(f"robot: got {robot}, expected 0 to {len(self.names) - 1}, or a name")
        return int(robot)

    def check(self, which: Sequence[int] | None = None) -> None:
        """PlanningError where starts, or goals, collide: says who with whom.

        Robots that vanish at their goals may share them.
        """
        which = range(len(self.names)) if which is None else which
        for label, ends in (("start", self.starts), ("goal", self.goals)):
            world = self.world.copy()
            for i, q in zip(self.robots, ends, strict=True):
                world.set_configuration(i, q)
            for i in which:
                alone = self.vanish and label == "goal"
                seen = self.alone(i) if alone else world
                if alone:
                    seen.set_configuration(self.names[i], ends[i])
                self.check_there(seen, i, label)

    def check_there(self, world: World, i: int, label: str) -> None:
        """PlanningError where robot i collides as it stands in a world: at its start or goal.

        Its own links may only not touch, whatever the margin.
        """
        name, size = [self.names[i]], [self.models[i].nq]
        one = _core.Checker(
            world._core, name, size, [0], [1.0], [True], self.margin, TOLERANCE, 0.0
        )
        if not one.valid(world.configuration(self.names[i])):
            raise PlanningError(self._conflict(world, i, label))

    def _conflict(self, world: World, i: int, label: str) -> str:
        own = set(world.parts(self.names[i]).tolist())
        names = dict(zip(world.ids.tolist(), world.names, strict=True))
        pairs = world.contacts(margin=self.margin).tolist()
        met = [b if a in own else a for a, b in pairs if a in own or b in own]
        inside = [1 for a, b in world.contacts().tolist() if a in own and b in own]
        others = sorted({names[b].split("/")[0] for b in met if b not in own})
        told = " and ".join(others or (["itself"] if inside else ["something"]))
        near = f", or is closer than the margin of {self.margin:g} m" if self.margin else ""
        return f"{label} of {self.names[i]!r}: collides with {told}{near}; move it, or the {label}"
