"""Options of environments."""

from __future__ import annotations

import secrets
from collections.abc import Mapping
from difflib import get_close_matches
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from fgenv.arrays import Floats

from .simulator import Simulator
from .single_agent import real_numbers

Seed = TypeVar("Seed")
PLACES = ("starts", "goals")  # options of a reset


def refuse_worlds(environment: str, options: dict[str, Any]) -> None:
    """Raise TypeError if options include the number of worlds or autoreset."""
    for name in ("worlds", "autoreset"):
        if name in options:
            raise TypeError(
                f"{name}: got {options[name]!r}, which {environment} does not take; use"
                " fgenv.envs.Simulator, gymnasium.make_vec or fgenv.agents.FleetVecEnv"
            )


def check_reset_options(options: dict[str, Any] | None) -> None:
    """Raise TypeError unless the options of a reset are a dict or None.

    Unknown keys are accepted: the test suites of Gymnasium and PettingZoo pass some.
    """
    if options is not None and not isinstance(options, dict):
        raise TypeError(f"options: got {options!r}, expected a dict or None")


Places = dict[str, dict[int, Floats]]  # starts and goals, (worlds, nq), by robot


def places_in(simulator: Simulator, options: dict[str, Any] | None, worlds: int = 1) -> Places:
    """Return the checked `starts` and `goals` of the options of a reset.

    Args:
        worlds: number of worlds that begin; values are configurations (nq,) or (worlds, nq).

    Raises:
        TypeError, ValueError: a misspelt option, an unknown robot, a wrong shape, or a
            configuration outside the limits.
    """
    for key in options or {}:
        if key not in PLACES and get_close_matches(str(key), PLACES, cutoff=0.8):
            raise ValueError(f"options: got {key!r}, expected {' or '.join(PLACES)}")
    given = {key: (options or {}).get(key) or {} for key in PLACES}
    places: Places = {key: {} for key in PLACES}
    for key, values in given.items():
        if not isinstance(values, Mapping):
            kind = type(values).__name__
            raise TypeError(f"options: {key}: got {kind}, expected a dict by name of robot")
        for name, value in values.items():
            if name not in simulator.names:
                expected = ", ".join(simulator.names)
                raise ValueError(f"options: {key}: got {name!r}, expected one of {expected}")
            i = simulator.names.index(name)
            places[key][i] = _configurations(simulator, i, value, worlds, f"{key}: {name!r}")
    return places


def _configurations(simulator: Simulator, i: int, value: Any, worlds: int, label: str) -> Floats:
    """Configurations of robot i, (worlds, nq), within its limits."""
    robot, q = simulator.robots[i], real_numbers(value, f"options: {label}")
    if q.shape not in ((robot.nq,), (worlds, robot.nq)):
        raise ValueError(
            f"options: {label}: got shape {q.shape}, expected ({robot.nq},):"
            f" {', '.join(robot.coordinates)}"
        )
    if not np.all(robot.valid(q)):
        raise ValueError(f"options: {label}: got {q.tolist()}, expected it within the limits")
    return np.broadcast_to(q, (worlds, robot.nq))


def place_robots(simulator: Simulator, places: Places, worlds: ArrayLike | None = None) -> bool:
    """Place robots at starts and goals after a reset; return whether there are any.

    Args:
        worlds: numbers of the worlds that begin; None: all.

    Raises:
        ValueError: a start in contact. The episodes are then those of the scenario.
    """
    robots = sorted({i for by_robot in places.values() for i in by_robot})
    if not robots:
        return False
    before = simulator.state()
    which = range(simulator.n_worlds) if worlds is None else np.asarray(worlds).tolist()
    current = {"starts": simulator.configurations, "goals": simulator.goals}
    for k, world in enumerate(which):
        for i in robots:
            nq = simulator.robots[i].nq
            ends = (
                places[key][i][k] if i in places[key] else current[key][world, i, :nq]
                for key in PLACES
            )
            simulator.place(world, i, *ends)
        placed = simulator.world(world)
        pairs = placed.contact_pairs().tolist()
        if pairs:
            names = dict(zip(placed.ids.tolist(), placed.names, strict=True))
            simulator.set_state(before)
            a, b = (names[body] for body in pairs[0])
            raise ValueError(f"options: starts: got {a!r} in contact with {b!r}, expected none")
    return True


def first_seed(simulator: Simulator, seed: Seed | None) -> Seed | int | None:
    """Return the seed of a reset: before the first one, fresh entropy if there is none."""
    return secrets.randbits(32) if seed is None and not simulator.begun else seed
