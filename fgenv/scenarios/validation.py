"""What is wrong with a scenario that the schema lets pass: names, files, limits, places."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fgenv.arrays import Floats
from fgenv.robots import Robot
from fgenv.scenarios.shapes.bodies import MeshFile

from .build import ROBOTS, STATIC, Built, assembled, model_of, robot_of
from .errors import Location, Problem, near, path_text

if TYPE_CHECKING:
    from .schema import Body, RobotSpec, Scenario

FAULTS = (ValueError, TypeError, OSError, ImportError)  # of a shape or model that cannot be built
ENDS = ("start", "goal")


class Found(NamedTuple):
    """Something wrong."""

    place: Location
    text: str
    remedy: str

    @property
    def problem(self) -> Problem:
        """As users see it; the line is told by who has the file."""
        return Problem(self.text, self.remedy, path_text(self.place))


def problems(scenario: Scenario) -> list[Problem]:
    """See `Scenario.problems`."""
    return [found.problem for found in everything(scenario)]


def everything(scenario: Scenario, gone: Collection[str] = ()) -> list[Found]:
    """All that is wrong. What hangs on something wrong, or on names `gone`, is left out."""
    found = [*references(scenario, gone), *files(scenario)]
    bad = {(f.place[0], f.place[1]) for f in found if len(f.place) > 1}
    built, robots, faults = buildable(scenario, bad)
    found += [f for f in faults if f.place[:2] not in bad]
    return found + list(places(built, robots))


def references(scenario: Scenario, gone: Collection[str] = ()) -> Iterator[Found]:
    """Names that nothing bears, or that two bear."""
    for name, model in scenario.models.items():
        if model.shape is not None:
            yield from _known(("models", name, "shape"), model.shape, scenario.shapes, gone)
    for i, robot in enumerate(scenario.robots):
        yield from _known(("robots", i, "model"), robot.model, scenario.models, gone)
    for i, body in enumerate(scenario.bodies):
        yield from _known(("bodies", i, "shape"), body.shape, scenario.shapes, gone)
    yield from _repeated(scenario)
    parts: list[RobotSpec | Body] = [*scenario.robots, *scenario.bodies]
    groups = {ROBOTS, STATIC, *(g for p in parts for g in (p.name or "", *p.groups))}
    for i, pair in enumerate(scenario.allowed):
        for k in (0, 1):
            yield from _known(("allowed", i, k), pair[k], groups - {""}, gone)
    if scenario.time_step > scenario.horizon:
        text = f"is {scenario.time_step:g} s, longer than the horizon of {scenario.horizon:g} s"
        yield Found(("time_step",), text, "shorten it")


def _known(
    place: Location, name: str, known: Collection[str], gone: Collection[str]
) -> Iterator[Found]:
    if name not in known and name not in gone:
        yield Found(place, f"nothing is named {name!r}", near(name, known))


def _repeated(scenario: Scenario) -> Iterator[Found]:
    named = [(("robots", i, "name"), r.name) for i, r in enumerate(scenario.robots)]
    named += [
        (("bodies", i, "name"), b.name or f"body {i + 1}") for i, b in enumerate(scenario.bodies)
    ]
    count = Counter(name for _, name in named)
    for place, name in named:
        if count[name] > 1:
            yield Found(
                place, f"{name!r} names {count[name]} robots or bodies", "rename all but one"
            )


def files(scenario: Scenario) -> Iterator[Found]:
    """Mesh files that are missing, or have another hash."""
    for name, form in scenario.shapes.items():
        if isinstance(form, MeshFile):
            place, path = ("shapes", name), form.path(scenario.folder)
            if not path.is_file():
                what = "is a folder" if path.is_dir() else "does not exist"
                told = "put it there, or write its path relative to the scenario file"
                yield Found((*place, "file"), f"{path} {what}", told)
                continue
            try:
                form.check_hash(scenario.folder)
            except (OSError, ValueError) as error:
                told = "get the file that was meant, or write its hash"
                yield Found((*place, "sha256"), str(error), told)


def buildable(
    scenario: Scenario, bad: Collection[tuple[str | int, str | int]]
) -> tuple[Built, list[int], list[Found]]:
    """All of a scenario that can be built, the places of its robots, and why the rest cannot."""
    found: list[Found] = []
    shapes, models, robots = {}, {}, {}
    for name, form in scenario.shapes.items():
        if ("shapes", name) not in bad:
            try:
                shapes[name] = form.shape(scenario.folder)
            except FAULTS as error:
                found.append(Found(("shapes", name), _line(error), ""))
    for name, model in scenario.models.items():
        if model.shape is None or model.shape in shapes:
            try:
                models[name] = model_of(scenario, model)
            except FAULTS as error:
                part = ("drive",) if str(error).startswith("drive:") else ()
                found.append(Found(("models", name, *part), _line(error), ""))
    for i, spec in enumerate(scenario.robots):
        if spec.model in models:
            try:
                robots[i] = robot_of(models[spec.model], spec)
            except FAULTS as error:
                found.append(Found(("robots", i, "mount"), _line(error), ""))
    for i, robot in list(robots.items()):
        if wrong := list(configurations(scenario, i, robot)):
            found += wrong
            del robots[i]
    bodies = [i for i, body in enumerate(scenario.bodies) if body.shape in shapes]
    return assembled(distinct(scenario), shapes, robots, bodies), list(robots), found


def distinct(scenario: Scenario) -> Scenario:
    """The scenario with another name for what bears one that is taken."""
    seen: Counter[str] = Counter()
    changes = {}
    for what, prefix in (("robots", "robot"), ("bodies", "body")):
        named = []
        for i, item in enumerate(getattr(scenario, what)):
            name = item.name or f"{prefix} {i + 1}"
            seen[name] += 1
            other = name if seen[name] == 1 else f"{name} ({seen[name]})"
            named.append(item if other == item.name else item.model_copy(update={"name": other}))
        changes[what] = tuple(named)
    return scenario.model_copy(update=changes)


def _line(error: Exception) -> str:
    return " ".join(str(error).split()) or type(error).__name__


def configurations(scenario: Scenario, i: int, robot: Robot) -> Iterator[Found]:
    """Start and goal of a robot: as many numbers as it has coordinates, within its limits."""
    for end in ENDS:
        q, place = np.array(getattr(scenario.robots[i], end)), ("robots", i, end)
        if len(q) != robot.nq:
            told = f"has {len(q)} numbers, expected {robot.nq}: {', '.join(robot.coordinates)}"
            yield Found(place, told, "write one for each")
        elif not robot.valid(q):
            yield from _beyond(place, robot, q)


def _beyond(place: Location, robot: Robot, q: Floats) -> Iterator[Found]:
    """Which coordinates are outside which limits."""
    turn = [name for name in ("qx", "qy", "qz", "qw") if robot.base == "free"]
    for name, x, low, high in zip(robot.coordinates, q, robot.lower, robot.upper, strict=True):
        if (
            name not in turn
            and not low <= x <= high
            and not robot.endless[robot.coordinates.index(name)]
        ):
            what = "the workspace" if name in ("x", "y", "z") else "the joint's limits"
            told = f"{name} is {x:g}, outside {what}, {low:g} to {high:g}"
            yield Found(place, told, f"move it inside, or widen {what}")
    size = float(np.sqrt(np.sum(q[3:7] ** 2))) if turn else 1.0
    if abs(size - 1.0) > 1e-6:
        yield Found(
            place,
            f"its quaternion has length {size:g}, expected 1",
            "qx, qy, qz, qw = 0, 0, 0, 1 is level",
        )


def places(built: Built, numbers: Sequence[int]) -> Iterator[Found]:
    """Starts and goals that meet a body, each other, or the robot itself.

    Args:
        built: robots and bodies.
        numbers: places of its robots in the scenario.
    """
    for end, at in zip(ENDS, (built.starts, built.goals), strict=True):
        world = built.world(at)
        names = dict(zip(world.ids.tolist(), world.names, strict=True))
        owner = {
            body: i for i, own in enumerate(built.groups) for body in world.parts(own[0]).tolist()
        }
        seen = set()
        for pair in world.contact_pairs().tolist():
            a, b = (names[k] for k in pair)
            who = owner.get(pair[0]), owner.get(pair[1])
            vanish = built.scenario.at_goal == "vanish" and end == "goal"
            if who in seen or (vanish and None not in who and who[0] != who[1]):
                continue
            seen.add(who if None not in who else (a, b))
            yield _met(built, numbers, end, (a, b), who)


def _met(
    built: Built,
    numbers: Sequence[int],
    end: str,
    names: tuple[str, str],
    who: tuple[int | None, int | None],
) -> Found:
    """Two bodies that meet, told of the robot, or of the later of two."""
    one, other = who if who[1] is not None else who[::-1]
    assert other is not None
    place = ("robots", numbers[other], end)
    if one == other:
        return Found(
            place, f"the robot touches itself: {names[0]} and {names[1]}", f"move the {end}"
        )
    if one is None:
        body = names[0] if who[0] is None else names[1]
        return Found(place, f"meets {body!r}", f"move the {end}, or allow the contact")
    return Found(place, f"overlaps the {end} of {built.groups[one][0]!r}", "move one of them")
