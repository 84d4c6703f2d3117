"""Builds a scenario: robots, and plain arrays for the simulator."""

from __future__ import annotations

import contextlib
import importlib.util
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path

import numpy as np

from fgenv.arrays import Floats
from fgenv.collision import Shape, World
from fgenv.robots import Robot

from .model_parts import with_attached, with_locked_joints
from .schema import Model, RobotSpec, ScenarioSpec

ROBOTS, STATIC = "robots", "static"  # groups of all robots, and of all bodies


@dataclass(frozen=True, eq=False)
class Built:
    """The robots and arrays of a scenario; sequences are by robot or by static body.

    Attributes:
        robots: with drive, limits, workspace and mount.
        starts, goals: configurations, (nq,) each.
        groups: of each robot; they include its name and `robots`.
        shapes, poses: of the static bodies; poses are (m, 4, 4).
        names: of the static bodies.
        body_groups: of each static body; they include its name and `static`.
        allowed: pairs of groups that are excluded from collision checks.
    """

    scenario: ScenarioSpec
    robots: tuple[Robot, ...]
    starts: tuple[Floats, ...]
    goals: tuple[Floats, ...]
    groups: tuple[tuple[str, ...], ...]
    shapes: tuple[Shape, ...]
    poses: Floats
    names: tuple[str, ...]
    body_groups: tuple[tuple[str, ...], ...]
    allowed: tuple[tuple[str, str], ...]

    @classmethod
    def of(cls, scenario: ScenarioSpec) -> Built:
        """Build a scenario; reads each mesh and URDF file once.

        Raises:
            ValueError, OSError, ImportError: a shape or model is invalid.
        """
        shapes = {name: form.shape(scenario.folder) for name, form in scenario.shapes.items()}
        models = {name: robot_model(scenario, m) for name, m in scenario.models.items()}
        robots = {i: robot_of(models[r.model], r) for i, r in enumerate(scenario.robots)}
        return assemble(scenario, shapes, robots, range(len(scenario.bodies)))

    def world(self, configurations: Sequence[Floats] | None = None, robots: bool = True) -> World:
        """A world of the static bodies, then the robots, by their names.

        Pairs of static bodies are excluded from collision checks.

        Args:
            configurations: (nq,) of each robot; default: the starts.
            robots: whether to add the robots.
        """
        world = World()
        for a, b in self.allowed:
            if "/" not in a + b:
                world.allow_groups(a, b)
        bodies = zip(self.shapes, self.poses, self.names, self.body_groups, strict=True)
        for shape, pose, name, groups in bodies:
            world.add(shape, pose, name=name, groups=groups)
        if robots:
            for i, q in enumerate(self.starts if configurations is None else configurations):
                self.add_robot(world, i, q)
        return world

    def add_robot(self, world: World, i: int, q: Floats) -> int:
        """Add robot i at a configuration (nq,); returns its id.

        Raises:
            ValueError: `allowed` names a link that the robot does not have.
        """
        robot = world.add_robot(self.robots[i], q, name=self.groups[i][0], groups=self.groups[i])
        for pair in self.allowed:
            if "/" in "".join(pair):
                self._allow_links(world, pair)
        return robot

    def _allow_links(self, world: World, pair: tuple[str, str]) -> None:
        """Exclude a pair from collision checks of which at least one is a link, ROBOT/LINK."""
        first, second = (self._members(world, name) for name in pair)
        for a in first:
            for b in second:
                if a != b:
                    world.allow(a, b)

    def _members(self, world: World, name: str) -> list[int]:
        """Ids of the bodies of a link, or of a group, that are in a world."""
        present = dict(zip(world.names, world.ids.tolist(), strict=True))
        if "/" not in name:
            own = [i for i, groups in enumerate(self.groups) if name in groups]
            robots = [int(b) for i in own if self.groups[i][0] in present
                      for b in world.parts(self.groups[i][0])]  # fmt: skip
            bodies = zip(self.names, self.body_groups, strict=True)
            return robots + [present[body] for body, groups in bodies if name in groups]
        label, _, link = name.partition("/")
        own = [i for i, groups in enumerate(self.groups) if groups[0] == label]
        if not own:
            raise ValueError(f"allowed: got {name!r}, expected ROBOT/LINK of a robot here")
        if label not in present:
            return []
        i = own[0]
        at = self.robots[i].link_index(link)
        ids = zip(world.parts(label).tolist(), self.robots[i].parts, strict=False)
        return [body for body, part in ids if part.link == at]


def assemble(
    scenario: ScenarioSpec,
    shapes: Mapping[str, Shape],
    robots: Mapping[int, Robot],
    bodies: Sequence[int],
) -> Built:
    """A selection of a scenario's robots and bodies, by their indices in it."""
    specs = [scenario.robots[i] for i in robots]
    stand = [scenario.bodies[i] for i in bodies]
    names = tuple(body.name or f"body {i + 1}" for i, body in zip(bodies, stand, strict=True))
    return Built(
        scenario,
        tuple(robots.values()),
        tuple(np.array(spec.start) for spec in specs),
        tuple(np.array(spec.goal) for spec in specs),
        tuple((spec.name, ROBOTS, *spec.groups) for spec in specs),
        tuple(shapes[body.shape] for body in stand),
        np.array([body.pose for body in stand]).reshape(-1, 4, 4),
        names,
        tuple((n, STATIC, *b.groups) for n, b in zip(names, stand, strict=True)),
        (*scenario.allowed, (STATIC, STATIC)),
    )


def robot_model(scenario: ScenarioSpec, model: Model) -> Robot:
    """The robot of a model, at the origin."""
    drive = None if model.drive is None else model.drive.build()
    base = model.base or ("fixed" if model.urdf else "planar")
    space = None
    if scenario.workspace is not None and base != "fixed":
        box = np.array([scenario.workspace.low, scenario.workspace.high])
        space = box[:, :2] if base == "planar" else box
    if model.urdf is None:
        shape = scenario.shapes[model.shape or ""].shape(scenario.folder)
        return Robot.from_mesh(shape, base, drive=drive, workspace=space)
    path = urdf_path(model.urdf, scenario.folder)
    srdf = None if model.srdf is None else urdf_path(model.srdf, scenario.folder, "srdf")
    robot = Robot.load(path, base, workspace=space, srdf=srdf)
    shapes = {item.shape: scenario.shapes[item.shape].shape(scenario.folder)
              for item in model.attached if item.shape in scenario.shapes}  # fmt: skip
    robot = with_attached(with_locked_joints(robot, model.locked), model.attached, shapes)
    return robot.with_allowed_collisions(model.allowed).replace(drive=drive)


def robot_of(model: Robot, spec: RobotSpec) -> Robot:
    """The model with a name and a mount; the model's kinematics may be shared."""
    return model.replace(name=spec.name, mount=spec.mount.pose)


def urdf_path(urdf: str, folder: Path | None, what: str = "urdf") -> Path:
    """The URDF or SRDF file: a path, or package://NAME/PATH in a folder of Python packages.

    NAME is a Python package, or a folder of example-robot-data where that is installed.
    """
    if not urdf.startswith("package://"):
        return (folder or Path()) / urdf
    name, _, rest = urdf.removeprefix("package://").partition("/")
    tried = list(_places(name, rest))
    for path in tried:
        if path.is_file():
            return path
    looked = ", ".join(map(str, tried)) or "no Python package has that name"
    raise FileNotFoundError(f"{what}: {urdf} is not there ({looked}); remedy: install {name!r}")


def _places(name: str, rest: str) -> Iterator[Path]:
    if name.isidentifier() and (spec := importlib.util.find_spec(name)) is not None:
        for folder in spec.submodule_search_locations or ():
            yield Path(folder) / rest
    with contextlib.suppress(PackageNotFoundError):
        robots = "cmeel.prefix/share/example-robot-data/robots"
        yield Path(str(distribution("example-robot-data").locate_file(robots))) / name / rest
