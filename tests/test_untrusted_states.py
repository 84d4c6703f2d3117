"""Damaged states of worlds and simulators are refused, or give an equal result; nothing crashes."""

from __future__ import annotations

import pickle
import random
import struct
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest

from fgenv.collision import Shape, World
from fgenv.envs import Simulator
from fgenv.scenarios import Scenario

VALUES: list[Any] = [
    None, True, -1, 0, 1, 3, 2**31 - 1, -(2**31), 2**40, 0.5, float("nan"), float("inf"), "", "x",
    b"x", [], [0], [-1], [2**31 - 1], [[0]], (), {}, np.zeros(0), np.zeros((4, 4)), np.eye(3),
    np.full((4, 4), np.nan), np.eye(4) * 1e300, np.zeros((0, 4, 4)), object(),
]  # fmt: skip


def world() -> World:
    """Static and carried bodies, a robot, paths, trajectories, groups and allowed pairs."""
    world = Scenario.load("cell", n=2).build().world()
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float) * 0.1
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    shape, far = Shape(vertices, faces), np.eye(4)
    far[:3, 3] = 50.0
    a, b = (
        world.add(shape, far, name="a", groups=["g"]),
        world.add(shape, far, name="b", groups=["h"]),
    )
    world.attach(b, a)
    world.allow(a, b)
    path = np.tile(far, (3, 1, 1))
    path[:, 0, 3] += [0.0, 1.0, 2.0]
    world.set_path(a, path)
    world.set_trajectory(world.add(shape, far, name="c"), [0.0, 1.0, 2.0], path)
    return world


def damages(state: Any, at: tuple[Any, ...] = ()) -> Iterator[tuple[tuple[Any, ...], Any]]:
    """Paths to each value of nested containers, with each other value to put there."""
    for value in VALUES:
        yield at, value
    if isinstance(state, dict):
        items: Any = state.items()
    elif isinstance(state, (list, tuple)):
        items = enumerate(state)
    else:
        return
    for key, value in items:
        yield from damages(value, (*at, key))


def changed(state: Any, at: tuple[Any, ...], value: Any) -> Any:
    """A copy of a state with another value at a path."""
    if not at:
        return value
    new = dict(state) if isinstance(state, dict) else list(state)
    new[at[0]] = changed(state[at[0]], at[1:], value)
    return tuple(new) if isinstance(state, tuple) else new


def use(world: World) -> None:
    """Queries that walk all bodies, masks, bonds and trajectories."""
    for body in world.ids:
        world.record(int(body))
        world.poses([int(body)])
    roots = [int(i) for i in world.ids if world.record(int(i)).carrier is None]
    world.clearance(roots[0], world.poses([roots[0]])[0])
    world.raycast([[0.0, 0.0, 1.0]], [[1.0, 0.0, 0.0]])
    pickle.dumps(world)


def outcome(state: Any) -> str:
    new = World.__new__(World)
    try:
        new.__setstate__(state)
    except ValueError as error:
        is_clear = "World: got a damaged state" in str(error) and len(str(error)) < 1000
        return "refused" if is_clear else f"refused without a clear reason: {error}"
    use(new)
    return "accepted"


def test_a_valid_state_is_accepted() -> None:
    state = world().__getstate__()
    assert outcome(state) == "accepted"


def test_damaged_worlds_are_refused_or_work() -> None:
    state = world().__getstate__()
    every = list(damages({k: v for k, v in state.items() if k != "models"}))
    some = random.Random(0).sample(every, min(len(every), 1500))
    for at, value in some:
        damaged = changed(state, at, value) if at else value
        assert outcome(damaged) in ("refused", "accepted"), (at, value)


@pytest.mark.parametrize("key", ["path", "configuration", "bodies"])
def test_faults_that_crashed_are_refused(key: str) -> None:
    """Empty arrays, and numbers instead of lists, once ended the process."""
    state = world().__getstate__()
    assert outcome({**state, "bodies": 2**40}) == "refused"
    for k, body in enumerate(state["bodies"]):
        if key in body and body[key] is not None:
            empty = np.zeros((0, *np.shape(body[key])[-2:]))
            assert outcome(changed(state, ("bodies", k, key), empty)) == "refused"


@pytest.mark.parametrize(
    "key", ["shape", "carrier", "root", "link", "parts", "pose", "offset", "id"]
)
def test_each_field_that_could_crash_is_refused(key: str) -> None:
    state = world().__getstate__()
    values: list[Any] = [None, "x", 2**31 - 1, -(2**31), [2**31 - 1], np.full((4, 4), np.nan)]
    for k in range(len(state["bodies"])):
        for value in values:
            assert outcome(changed(state, ("bodies", k, key), value)) == "refused", (k, value)


def test_missing_fields_are_refused() -> None:
    state = world().__getstate__()
    for key in state:
        assert outcome({k: v for k, v in state.items() if k != key}) == "refused", key
    for key in state["bodies"][0]:
        if key != "mask":  # derived from the paths
            bodies = [{k: v for k, v in b.items() if k != key} for b in state["bodies"]]
            assert outcome({**state, "bodies": bodies}) == "refused", key


def begun() -> Simulator:
    simulator = Simulator("swap", n=2, worlds=2)
    simulator.reset(seed=0)
    simulator.step(np.full((2, 2, simulator.action_size), 0.3))
    return simulator


def flips(state: bytes, random: random.Random) -> bytes:
    k = random.randrange(len(state))
    return state[:k] + bytes([state[k] ^ 1 << random.randrange(8)]) + state[k + 1 :]


def numbers(state: bytes, random: random.Random) -> bytes:
    k = random.randrange(0, len(state) - 8)
    value = random.choice([np.nan, np.inf, -1.0, 1e308])
    return state[:k] + struct.pack("<d", value) + state[k + 8 :]


def integers(state: bytes, random: random.Random) -> bytes:
    k = random.randrange(0, len(state) - 8)
    return (
        state[:k] + struct.pack("<q", random.choice([-1, 2**31, 2**62, -(2**63)])) + state[k + 8 :]
    )


def cuts(state: bytes, random: random.Random) -> bytes:
    return state[: random.randrange(len(state))]


def insertions(state: bytes, random: random.Random) -> bytes:
    k = random.randrange(len(state))
    return state[:k] + random.randbytes(random.randrange(1, 20)) + state[k:]


@pytest.mark.parametrize("damage", [flips, numbers, integers, cuts, insertions])
def test_damaged_simulators_are_refused_or_step(
    damage: Callable[[bytes, random.Random], bytes],
) -> None:
    simulator, rng = begun(), random.Random(1)
    state = simulator.state()
    for _ in range(400):
        damaged = damage(state, rng)
        try:
            simulator.set_state(damaged)
        except ValueError:
            if damage in (cuts, insertions):
                continue
            simulator.set_state(state)
        for name in ("configurations", "goals", "remaining", "traveled"):
            assert np.isfinite(getattr(simulator, name)).all()
        assert simulator.state() in (state, damaged)
        simulator.step(np.zeros((2, 2, simulator.action_size)))
    simulator.set_state(state)
    assert simulator.state() == state
