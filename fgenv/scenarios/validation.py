"""Faults of a scenario that the schema cannot express: names, files, limits, contacts."""

from __future__ import annotations

import difflib
from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from fgenv.arrays import Floats
from fgenv.robots import Robot
from fgenv.scenarios.shapes.bodies import MeshFile

from .build import ROBOTS, STATIC, Built, assemble, robot_model, robot_of
from .errors import Location, Problem, cut, near, path_text
from .schema import Body, RobotSpec, ScenarioSpec

BUILD_ERRORS = (ValueError, TypeError, OSError, ImportError)  # raised by shapes and models
MAX_SUGGESTED = 1000  # invalid names that are compared with an unknown one
ENDS = ("start", "goal")


class Fault(NamedTuple):
    """A fault, and its location in the scenario."""

    place: Location
    text: str
    remedy: str

    @property
    def problem(self) -> Problem:
        """The fault without a line, which only a file has."""
        return Problem(self.text, self.remedy, path_text(self.place))


def problems(scenario: ScenarioSpec) -> list[Problem]:
    """See `Scenario.problems`."""
    return [fault.problem for fault in all_faults(scenario)]


def all_faults(scenario: ScenarioSpec, dropped: Collection[str] = ()) -> list[Fault]:
    """All faults; those that only follow from another fault or a dropped name are left out."""
    faults = [*reference_faults(scenario, dropped), *file_faults(scenario)]
    invalid = {(f.place[0], f.place[1]) for f in faults if len(f.place) > 1}
    built, robots, build_faults = build_valid(scenario, invalid)
    faults += [f for f in build_faults if f.place[:2] not in invalid]
    return faults + list(contact_faults(built, robots))


def reference_faults(scenario: ScenarioSpec, dropped: Collection[str] = ()) -> Iterator[Fault]:
    """References to names that do not exist, and names that exist twice."""
    for name, model in scenario.models.items():
        if model.shape is not None:
            yield from _reference(("models", name, "shape"), model.shape, scenario.shapes, dropped)
        for i, item in enumerate(model.attached):
            place = ("models", name, "attached", i, "shape")
            yield from _reference(place, item.shape, scenario.shapes, dropped)
    for i, robot in enumerate(scenario.robots):
        yield from _reference(("robots", i, "model"), robot.model, scenario.models, dropped)
    for i, body in enumerate(scenario.bodies):
        yield from _reference(("bodies", i, "shape"), body.shape, scenario.shapes, dropped)
    yield from _repeated_names(scenario)
    parts: list[RobotSpec | Body] = [*scenario.robots, *scenario.bodies]
    groups = {ROBOTS, STATIC, *(g for p in parts for g in (p.name or "", *p.groups))}
    for i, pair in enumerate(scenario.allowed):
        for k in (0, 1):
            label, slash, _ = pair[k].partition("/")
            known: Collection[str] = groups - {""}
            if slash and all(spec.name != label for spec in scenario.robots):
                known = [f"{spec.name}/..." for spec in scenario.robots]
            elif slash:  # the link is checked once the robot is built
                known = [pair[k]]
            yield from _reference(("allowed", i, k), pair[k], known, dropped)
    if scenario.time_step > scenario.horizon:
        text = f"is {scenario.time_step:g} s, longer than the horizon of {scenario.horizon:g} s"
        yield Fault(("time_step",), text, "shorten it")


def _reference(
    place: Location, name: str, known: Collection[str], dropped: Collection[str]
) -> Iterator[Fault]:
    if name not in known and name not in dropped:
        invalid = [cut(other) for other in sorted(dropped)[:MAX_SUGGESTED]]
        names = [*known, *difflib.get_close_matches(name, invalid)]
        remedy = near(name, names) if names else "no such items are defined; add it"
        yield Fault(place, f"nothing is named {name!r}", remedy)


def _repeated_names(scenario: ScenarioSpec) -> Iterator[Fault]:
    named = [(("robots", i, "name"), r.name) for i, r in enumerate(scenario.robots)]
    named += [
        (("bodies", i, "name"), b.name or f"body {i + 1}") for i, b in enumerate(scenario.bodies)
    ]
    count = Counter(name for _, name in named)
    for place, name in named:
        if count[name] > 1:
            text = f"{name!r} names {count[name]} robots or bodies"
            yield Fault(place, text, "rename all but one")


def file_faults(scenario: ScenarioSpec) -> Iterator[Fault]:
    """Mesh files that are missing or have another hash."""
    for name, shape in scenario.shapes.items():
        if not isinstance(shape, MeshFile):
            continue
        place, path = ("shapes", name), shape.path(scenario.folder)
        if not path.is_file():
            state = "is a folder" if path.is_dir() else "does not exist"
            remedy = "put it there, or write its path relative to the scenario file"
            yield Fault((*place, "file"), f"{path} {state}", remedy)
            continue
        try:
            shape.check_hash(scenario.folder)
        except (OSError, ValueError) as error:
            remedy = "get the file with this hash, or update the hash"
            yield Fault((*place, "sha256"), str(error), remedy)


def build_valid(
    scenario: ScenarioSpec, invalid: Collection[tuple[str | int, str | int]]
) -> tuple[Built, list[int], list[Fault]]:
    """Build the valid parts of a scenario.

    Returns:
        The valid parts, the indices of their robots in the scenario, and the faults of the rest.
    """
    faults: list[Fault] = []
    shapes, models, robots = {}, {}, {}
    for name, form in scenario.shapes.items():
        if ("shapes", name) not in invalid:
            try:
                shapes[name] = form.shape(scenario.folder)
            except BUILD_ERRORS as error:
                faults.append(Fault(("shapes", name), _line(error), ""))
    for name, model in scenario.models.items():
        if model.shape is None or model.shape in shapes:
            try:
                models[name] = robot_model(scenario, model)
            except BUILD_ERRORS as error:
                part = ("drive",) if str(error).startswith("drive:") else ()
                faults.append(Fault(("models", name, *part), _line(error), ""))
    for i, spec in enumerate(scenario.robots):
        if spec.model not in models:
            continue
        try:
            robot = robot_of(models[spec.model], spec)
        except BUILD_ERRORS as error:
            faults.append(Fault(("robots", i, "mount"), _line(error), ""))
            continue
        if wrong := list(_configuration_faults(scenario, i, robot)):
            faults += wrong
        else:
            robots[i] = robot
        faults += _link_faults(scenario, robot)
    bodies = [i for i, body in enumerate(scenario.bodies) if body.shape in shapes]
    known = {f"{r.name}/{link.name}" for r in robots.values() for link in r.links}
    allowed = [p for p in scenario.allowed if all("/" not in name or name in known for name in p)]
    distinct = _with_distinct_names(scenario.model_copy(update={"allowed": tuple(allowed)}))
    return assemble(distinct, shapes, robots, bodies), list(robots), faults


def _link_faults(scenario: ScenarioSpec, robot: Robot) -> Iterator[Fault]:
    """Links in `allowed` that the robot does not have."""
    links = [f"{robot.name}/{link.name}" for link in robot.links]
    for i, pair in enumerate(scenario.allowed):
        for k in (0, 1):
            if pair[k].startswith(f"{robot.name}/"):
                yield from _reference(("allowed", i, k), pair[k], links, ())


def _with_distinct_names(scenario: ScenarioSpec) -> ScenarioSpec:
    """The scenario with a new name for each robot or body with a repeated name."""
    seen: Counter[str] = Counter()
    changes = {}
    for key, prefix in (("robots", "robot"), ("bodies", "body")):
        items = []
        for i, item in enumerate(getattr(scenario, key)):
            name = item.name or f"{prefix} {i + 1}"
            seen[name] += 1
            distinct = name if seen[name] == 1 else f"{name} ({seen[name]})"
            update = {"name": distinct}
            items.append(item if distinct == item.name else item.model_copy(update=update))
        changes[key] = tuple(items)
    return scenario.model_copy(update=changes)


def _line(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__


def _configuration_faults(scenario: ScenarioSpec, i: int, robot: Robot) -> Iterator[Fault]:
    """Starts and goals with a wrong number of coordinates, or outside the robot's limits."""
    for end in ENDS:
        q, place = np.array(getattr(scenario.robots[i], end)), ("robots", i, end)
        if len(q) != robot.nq:
            text = f"has {len(q)} numbers, expected {robot.nq}: {', '.join(robot.coordinates)}"
            yield Fault(place, text, "write one for each")
        elif not robot.valid(q):
            yield from _limit_faults(place, robot, q)


def _limit_faults(place: Location, robot: Robot, q: Floats) -> Iterator[Fault]:
    """The coordinates that are outside their limits."""
    quaternion = [name for name in ("qx", "qy", "qz", "qw") if robot.base == "free"]
    limits = zip(robot.coordinates, q, robot.lower, robot.upper, robot.endless, strict=True)
    for name, x, low, high, endless in limits:
        if name not in quaternion and not low <= x <= high and not endless:
            bounds = "the workspace" if name in ("x", "y", "z") else "the joint's limits"
            over = max(low - x, x - high)
            text = f"{name} is {x:g}, outside {bounds}, {low:g} to {high:g}, by {over:.2g}"
            yield Fault(place, text, f"move it inside, or widen {bounds}")
    length = float(np.sqrt(np.sum(q[3:7] ** 2))) if quaternion else 1.0
    if abs(length - 1.0) > 1e-6:
        text = f"its quaternion has length {length:g}, expected 1"
        yield Fault(place, text, "qx, qy, qz, qw = 0, 0, 0, 1 is level")


def contact_faults(built: Built, numbers: Sequence[int]) -> Iterator[Fault]:
    """Starts and goals in contact with a body, with another robot, or with the robot itself.

    Args:
        built: robots and bodies.
        numbers: indices of its robots in the scenario.
    """
    for end, configurations in zip(ENDS, (built.starts, built.goals), strict=True):
        world = built.world(configurations)
        names = dict(zip(world.ids.tolist(), world.names, strict=True))
        robot_of_body = {
            body: i for i, own in enumerate(built.groups) for body in world.parts(own[0]).tolist()
        }
        reported = set()
        for pair in world.contact_pairs().tolist():
            a, b = (names[k] for k in pair)
            robots = robot_of_body.get(pair[0]), robot_of_body.get(pair[1])
            vanish = built.scenario.at_goal == "vanish" and end == "goal"
            gone = vanish and None not in robots and robots[0] != robots[1]
            if robots in reported or gone:
                continue
            reported.add(robots if None not in robots else (a, b))
            yield _contact_fault(built, numbers, end, (a, b), robots)


def _contact_fault(
    built: Built,
    numbers: Sequence[int],
    end: str,
    names: tuple[str, str],
    robots: tuple[int | None, int | None],
) -> Fault:
    """The fault of two bodies in contact, located at the robot, or at the later of two."""
    one, other = robots if robots[1] is not None else robots[::-1]
    assert other is not None
    place = ("robots", numbers[other], end)
    if one == other:
        text = f"the robot touches itself: {names[0]} and {names[1]}"
        return Fault(place, text, f"move the {end}")
    if one is None:
        body = names[0] if robots[0] is None else names[1]
        return Fault(place, f"meets {body!r}", f"move the {end}, or allow the contact")
    return Fault(place, f"overlaps the {end} of {built.groups[one][0]!r}", "move one of them")
