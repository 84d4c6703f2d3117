"""Arguments of wrong types: one line that names the argument, what it got and what is expected.

A user who passes "5mm" as a margin gets that, not a signature dump or an error of NumPy.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import trimesh

import fgenv
from fgenv.collision import Shape, World, collide
from fgenv.envs import Reward

T = np.eye(4)
BOX = Shape(*(getattr(trimesh.creation.box(), name) for name in ("vertices", "faces")))
WORLD: Any = World()  # Any: what it gets is wrong on purpose
REWARD: Any = Reward
PLAN: Any = fgenv.plan
BODY = WORLD.add(BOX)

NUMBERS: dict[str, Callable[[Any], object]] = {
    "margin of collide": lambda x: collide(BOX, T, BOX, T, margin=x),
    "max_distance of a shape": lambda x: BOX.raycast([0, 0, 0], [0, 0, 1], None, x),
    "margin of collides": lambda x: WORLD.collides(BODY, T, margin=x),
    "margin of check_motion": lambda x: WORLD.check_motion(BODY, T, T, margin=x),
    "tolerance of check_motion": lambda x: WORLD.check_motion(BODY, T, T, tolerance=x),
    "margin of check_motions": lambda x: WORLD.check_motions([BODY], T[None], T[None], margin=x),
    "margin of advance": lambda x: WORLD.advance([BODY], T[None], margin=x),
    "margin of contact_pairs": lambda x: WORLD.contact_pairs(margin=x),
    "max_distance of a world": lambda x: WORLD.raycast([0, 0, 0], [0, 0, 1], max_distance=x),
    "progress of Reward": lambda x: REWARD({"progress": x}),
    "near of Reward": lambda x: REWARD(near=x),
    "margin of plan": lambda x: PLAN("swap", margin=x),
    "time_limit of plan": lambda x: PLAN("swap", time_limit=x),
}


@pytest.mark.parametrize("value", ["5mm", None, [1.0], object, True, 1j], ids=repr)
@pytest.mark.parametrize("call", NUMBERS.values(), ids=NUMBERS)
def test_a_number_of_a_wrong_type_is_named(
    call: Callable[[Any], object], value: object, request: pytest.FixtureRequest
) -> None:
    name = request.node.callspec.id.split(" of ")[0].split("-")[0]
    with pytest.raises((TypeError, ValueError)) as caught:
        call(value)
    message = str(caught.value)
    assert "\n" not in message
    assert f"{name}: got " in message
    assert "expected" in message


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: PLAN(WORLD), "scenario: got World, expected a Scenario, its name or its"),
        (lambda: PLAN("swap", seed="a"), "seed: got 'a', expected an integer, 0 or more"),
        (lambda: WORLD.add("a.stl"), "shape: got str, expected a Shape"),
        (lambda: REWARD(own={"x": len}), "reward: own: got {'x': .*}, expected pairs"),
        (lambda: REWARD(own=[(1, 2)]), r"reward: own: got \(1, 2\), expected a pair"),
        (lambda: REWARD({"progres": 1}), "reward: got 'progres'; did you mean 'progress'"),
        (lambda: fgenv.parallel_env("swap", max_cycles=0), "max_cycles: got 0, expected an int"),
        (
            lambda: WORLD.check_motion(BODY, T, T, start_time=np.zeros(2), end_time=np.ones(2)),
            r"start_time, end_time: got array\(\[0., 0.\]\) and .*, expected one number each",
        ),
        (
            lambda: WORLD.check_motion(BODY, T, T, first_contact="yes"),
            "first_contact: got 'yes', expected True or False",
        ),
        (
            lambda: WORLD.collides(BODY, T, threads=0),
            "threads: got 0, expected an integer from 1 to 4096",
        ),
    ],
)
def test_other_arguments_of_wrong_types_are_named(call: Callable[[], object], message: str) -> None:
    with pytest.raises((TypeError, ValueError), match=f"^{message}"):
        call()
