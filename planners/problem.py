"""Planning problem of a scenario."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from fgenv.arrays import Floats
from fgenv.collision import World
from fgenv.robots import Robot
from fgenv.robots.links_joints import number_of
from fgenv.scenarios import Built, Scenario
from fgenv.scenarios.library import ENTRIES

from .checker import joint_checker
from .errors import PlanningError


@dataclass(frozen=True, eq=False)
class Problem:
    """Robots that move from their starts to their goals.

    Attributes:
        built: the built scenario.
        world: all bodies, with the robots at their starts.
        margin: meters that robots keep from all bodies and from each other.
        seed: of all random numbers.
    """

    built: Built
    world: World
    margin: float = 0.0
    seed: int = 0

    @classmethod
    def from_scenario(
        cls,
        scenario: str | Path | Scenario | Problem,
        margin: float = 0.0,
        seed: int = 0,
        **overrides: Any,
    ) -> Problem:
        """Return the problem of a scenario, its name or its file; a Problem is returned as it is.

        Args:
            margin: meters.
            seed: also of a built-in scenario that is given by its name.
            overrides: for `Scenario.load`.
        """
        if isinstance(scenario, Problem):
            if overrides or margin not in (0.0, scenario.margin) or seed not in (0, scenario.seed):
                raise ValueError(
                    "margin, seed, overrides: a Problem has its own; expected a scenario"
                )
            return scenario
        if not isinstance(scenario, (str, Path, Scenario)):
            raise TypeError(
                f"scenario: got {type(scenario).__name__}, expected a Scenario, its name or its"
                " file, or a Problem"
            )
        number_of(margin, "margin", 0.0, finite=True)
        if not isinstance(seed, (int, np.integer)) or seed < 0:
            raise ValueError(f"seed: got {seed!r}, expected an integer, 0 or more")
        if isinstance(scenario, str) and scenario in ENTRIES:
            overrides.setdefault("seed", seed)
        if not isinstance(scenario, Scenario):
            scenario = Scenario.load(scenario, **overrides)
        if not scenario.robots:
            raise ValueError(f"scenario: {scenario.name!r} has no robots, expected one or more")
        built = scenario.build()
        return cls(built, built.world(), float(margin), int(seed))

    @property
    def scenario(self) -> Scenario:
        """The scenario of the problem."""
        assert isinstance(self.built.scenario, Scenario)
        return self.built.scenario

    @property
    def models(self) -> tuple[Robot, ...]:
        """Models of the robots."""
        return self.built.robots

    @property
    def starts(self) -> tuple[Floats, ...]:
        """Start configurations, (nq,) each."""
        return self.built.starts

    @property
    def goals(self) -> tuple[Floats, ...]:
        """Goal configurations, (nq,) each."""
        return self.built.goals

    @property
    def dt(self) -> float:
        """Time step, seconds."""
        return self.scenario.time_step

    @property
    def vanish(self) -> bool:
        """Whether robots vanish at their goals; else they stay there as obstacles."""
        return self.scenario.at_goal == "vanish"

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the robots."""
        return tuple(groups[0] for groups in self.built.groups)

    @cached_property
    def robot_ids(self) -> tuple[int, ...]:
        """Ids of the robots in `world`."""
        ids = dict(zip(self.world.names, self.world.ids.tolist(), strict=True))
        return tuple(
            ids[name] if name in ids else int(self.world.parts(name)[0]) for name in self.names
        )

    @cached_property
    def kinds(self) -> tuple[int, ...]:
        """Kind of each robot; interchangeable robots have the same kind and share a roadmap."""
        known: dict[Any, int] = {}
        named = {name.partition("/")[0] for pair in self.scenario.allowed for name in pair}
        keys = [
            (s.model, s.mount.pose.tobytes(), s.groups, s.name if s.name in named else "")
            for s in self.scenario.robots
        ]
        return tuple(known.setdefault(key, len(known)) for key in keys)

    def world_with(self, *robots: int) -> World:
        """World with the static bodies and some of the robots, at their starts."""
        world = self.built.world(robots=False)
        for i in robots:
            self.built.add_robot(world, i, self.starts[i])
        return world

    def index(self, robot: int | str) -> int:
        """Place of a robot that is given by its name or place.

        Raises:
            ValueError: no such robot.
        """
        if isinstance(robot, str):
            if robot not in self.names:
                raise ValueError(f"robot: got {robot!r}, expected one of {', '.join(self.names)}")
            return self.names.index(robot)
        if not 0 <= robot < len(self.names):
            raise ValueError(f"robot: got {robot}, expected 0 to {len(self.names) - 1}, or a name")
        return int(robot)

    def check(self) -> None:
        """Check the start and the goal of each robot; robots that vanish may share goals.

        Raises:
            PlanningError: a robot is outside its limits or collides; the message names the bodies.
        """
        for label, ends in (("start", self.starts), ("goal", self.goals)):
            world = self.world.copy()
            for robot, q in zip(self.robot_ids, ends, strict=True):
                world.set_configuration(robot, q)
            for i, name in enumerate(self.names):
                if self.vanish and label == "goal":
                    world = self.world_with(i)
                    world.set_configuration(name, ends[i])
                self.check_robot(world, i, label)

    def check_robot(self, world: World, i: int, label: str) -> None:
        """Check that robot i is within its limits and free at its configuration in a world.

        The margin does not apply between links of one robot.

        Args:
            label: `start` or `goal`, for the message.

        Raises:
            PlanningError: it is outside its workspace or its joint limits, or it collides.
        """
        if not self.models[i].valid(world.configuration(self.names[i])):
            raise PlanningError(
                f"{label} of {self.names[i]!r}: is outside its workspace or its joint limits;"
                f" move the {label}, or widen them"
            )
        checker = joint_checker(world, [self.names[i]], [self.models[i].nq], self.margin)
        if not checker.valid(world.configuration(self.names[i])):
            near = f", or is closer than the margin of {self.margin:g} m" if self.margin else ""
            raise PlanningError(
                f"{label} of {self.names[i]!r}: collides with {self._in_contact(world, i)}{near};"
                f" move it, or the {label}"
            )

    def _in_contact(self, world: World, i: int) -> str:
        """Names of the bodies that robot i collides with."""
        links = set(world.parts(self.names[i]).tolist())
        names = dict(zip(world.ids.tolist(), world.names, strict=True))
        touching = [
            b if a in links else a
            for a, b in world.contact_pairs(margin=self.margin).tolist()
            if a in links or b in links
        ]
        bodies = sorted({names[body].split("/")[0] for body in touching if body not in links})
        if bodies:
            return " and ".join(bodies)
        inside = any(a in links and b in links for a, b in world.contact_pairs().tolist())
        return "itself" if inside else "something"
