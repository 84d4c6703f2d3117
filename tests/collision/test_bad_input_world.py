"""Invalid arguments of World's methods raise one clear error and leave the world unchanged."""

from __future__ import annotations

import gc
import sys
from collections.abc import Callable
from functools import partial
from typing import Any

import hypothesis.strategies as st
import numpy as np
import pytest
from collision.test_bad_input import BAD_POINTS, BAD_POSES, says
from collision.test_fuzz import ANY_ARRAY
from hypothesis import given, settings

from fgenv.bench.common.solids import at, box
from fgenv.collision import Shape
from fgenv.collision.world import World

pytestmark = pytest.mark.native

CUBE = Shape(*box(1.0))
HERE = np.eye(4)
TWO = np.stack([at(9.0), at(12.0)])


def furnished() -> World:
    """robot 0 carries 1; 2 and 3 overlap; 4 is on a trajectory; 0 and 2 have paths."""
    world = World()
    for i, name in enumerate(("robot", "held", "crate", "box", "door")):
        world.add(CUBE, at(3.0 * i - (2.5 if i == 3 else 0.0)), name=name, groups=("g", name))
    world.attach("held", "robot")
    world.allow("robot", "door")
    world.allow_groups("g", "robot")
    world.set_trajectory("door", [0.0, 1.0], TWO)
    world.set_path("robot", [HERE, at(8.0)])
    world.set_path("crate", [at(6.0), at(9.0)])
    return world


def state(world: World) -> list[Any]:
    """Everything that can be read from a world."""
    ids = world.ids.tolist()
    records = [world.record(body) for body in ids]
    return [
        *(ids, world.names, len(world), world.contact_pairs().tolist()),
        *(world.poses(ids).tolist(), [world.mask(body) for body in ids]),
        *([(r.name, r.carrier, sorted(r.groups)) for r in records],),
        *(world.candidates("robot").tolist(), world.candidates("crate").tolist()),
        world.motion_boxes("robot").tolist(),
        world.collides("crate", at(9.0), times=0.0),
        world.check_motion("robot", HERE, at(20.0)).other,
        [world.collides(body, at(6.2)) for body in (0, 2, 3, 4)],
    ]


@pytest.fixture
def world() -> Any:
    """A world that must be unchanged after the test, and must still work."""
    made = furnished()
    before = state(made)
    yield made
    assert state(made) == before
    new = made.add(CUBE, at(9.2))
    assert new == 5
    assert made.collides("crate", at(9.0))
    made.remove(new)
    assert state(made) == before


def refuses(
    call: Callable[[], Any],
    *words: str,
    error: type[Exception] | tuple[type[Exception], ...] = (ValueError, TypeError),
) -> None:
    with pytest.raises(error) as caught:
        call()
    says(caught.value, *words)


# Bodies

Call = Callable[[World, Any], Any]
BODIES: dict[str, tuple[str, Call]] = {
    "remove": ("body", lambda w, x: w.remove(x)),
    "mask": ("body", lambda w, x: w.mask(x)),
    "record": ("body", lambda w, x: w.record(x)),
    "attach body": ("body", lambda w, x: w.attach(x, 3)),
    "attach carrier": ("carrier", lambda w, x: w.attach(3, x)),
    "allow a": (r"\ba\b", lambda w, x: w.allow(x, 3)),
    "allow b": (r"\bb\b", lambda w, x: w.allow(3, x)),
    "detach": ("body", lambda w, x: w.detach(x)),
}
ROBOTS: dict[str, tuple[str, Call]] = {
    "set_trajectory": ("body", lambda w, x: w.set_trajectory(x, [0.0, 1.0], TWO)),
    "forget trajectory": ("body", lambda w, x: w.set_trajectory(x, None, None)),
    "set_path": ("robot", lambda w, x: w.set_path(x, TWO)),
    "clear_path": ("robot", lambda w, x: w.clear_path(x)),
    "candidates": ("robot", lambda w, x: w.candidates(x)),
    "motion_boxes": ("robot", lambda w, x: w.motion_boxes(x)),
    "own_bit": ("robot", lambda w, x: w.own_bit(x)),
    "collides": ("robot", lambda w, x: w.collides(x, TWO)),
    "clearance": ("robot", lambda w, x: w.clearance(x, TWO)),
    "check_motion": ("robot", lambda w, x: w.check_motion(x, HERE, TWO)),
}
LISTS: dict[str, tuple[str, Call]] = {
    "set_pose": ("ids", lambda w, x: w.set_pose(x, HERE)),
    "poses": ("ids", lambda w, x: w.poses(x)),
    "raycast": ("ignore", lambda w, x: w.raycast([0, 0, 0], [1, 0, 0], ignore=x)),
    "check_motions": ("robots", lambda w, x: w.check_motions(x, HERE, HERE)),
}
UNKNOWN: dict[str, tuple[Any, tuple[str, ...]]] = {
    "an id too high": (99, ("99", "ids")),
    "a negative id": (-1, ("-1", "ids")),
    "an id over 32 bits": (2**40, (str(2**40), "ids")),
    "an id that is 2 in its lowest 32 bits": (2**32 + 2, (str(2**32 + 2), "ids")),
    "a name": ("unknown", ("unknown", "names")),
    "an empty name": ("", ("names",)),
    "a name cut off by a NUL": ("crate\0", ("got 'crate",)),
}
NO_BODIES: dict[str, tuple[Any, tuple[str, ...]]] = {
    "None": (None, ("expected", "None")),
    "a float": (1.0, ("expected", "float")),
    "NaN": (np.nan, ("expected", "float")),
    "True": (True, ("expected", "bool")),
    "bytes": (b"crate", ("expected", "bytes")),
    "a shape": (CUBE, ("expected", "Shape")),
    "a pair": ((2, 3), ("expected", "tuple")),
}


@pytest.mark.parametrize("call", BODIES | ROBOTS)
def test_what_is_no_body(world: World, call: str) -> None:
    name, ask = (BODIES | ROBOTS)[call]
    for cases, error in ((UNKNOWN, ValueError), (NO_BODIES, TypeError)):
        for value, words in cases.values():
            refuses(partial(ask, world, value), name, *words, error=error)


@pytest.mark.parametrize("call", LISTS)
def test_what_is_no_body_in_a_list(world: World, call: str) -> None:
    name, ask = LISTS[call]
    for value, words in UNKNOWN.values():
        for given_ in (value, [2, value], (value, 2), iter([2, value])):
            refuses(partial(ask, world, given_), name, *words, error=ValueError)


@pytest.mark.parametrize("call", LISTS)
def test_what_is_no_list_of_bodies(world: World, call: str) -> None:
    name, ask = LISTS[call]
    for value in (
        *(1.5, np.nan, b"ab", CUBE, {2: 3.0}.items()),
        *([[2, 3]], [2, 2.0], [2, None], [True, False], [b"crate"]),
        *(np.array([2.0]), np.zeros((2, 2), int), np.array([object()])),
    ):
        refuses(partial(ask, world, value), name, "expected|no body")


EVERY = BODIES | ROBOTS | LISTS


def test_a_name_that_is_no_unicode(world: World) -> None:
    for name, ask in EVERY.values():
        refuses(partial(ask, world, "\ud800"), name)


def test_an_id_over_64_bits(world: World) -> None:
    for name, ask in EVERY.values():
        refuses(partial(ask, world, 2**70), name, str(2**70), error=ValueError)


def test_an_array_is_not_one_body(world: World) -> None:
    for name, ask in (BODIES | ROBOTS).values():
        refuses(partial(ask, world, np.array([2, 3])), name, "expected", error=TypeError)


def test_a_stranger_that_fails_when_asked(world: World) -> None:
    class Stranger:
        def __index__(self) -> int:
            raise RuntimeError("not telling")

    for _, ask in EVERY.values():
        with pytest.raises((ValueError, TypeError, RuntimeError)):
            ask(world, Stranger())


@pytest.mark.parametrize("call", ROBOTS)
def test_a_carried_body_is_no_robot(world: World, call: str) -> None:
    name, ask = ROBOTS[call]
    for carried in (1, "held"):
        refuses(partial(ask, world, carried), name, "held", "carried", "robot")


def test_a_carried_body_is_not_put_or_moved_by_itself(world: World) -> None:
    refuses(lambda: world.set_pose("held", HERE), "ids", "held", "carried", "robot")
    refuses(lambda: world.set_pose([2, 1], HERE), "ids", "held", "carried", "detach")
    refuses(lambda: world.check_motions([2, 1], HERE, HERE), "robots", "held", "carried")


def test_a_removed_body_is_gone() -> None:
    world = furnished()
    gone = world.add(CUBE, at(90.0), name="gone")
    world.remove(gone)
    for call, (name, ask) in (BODIES | ROBOTS | LISTS).items():
        for body in (gone, "gone"):
            refuses(partial(ask, world, body), name, call and str(body))


# Adding


@pytest.mark.parametrize("shape", [None, "cube", box(1.0), HERE, Shape, 3])
def test_what_is_no_shape(world: World, shape: Any) -> None:
    with pytest.raises(TypeError, match="shape"):
        world.add(shape)


def test_names_that_are_taken(world: World) -> None:
    refuses(lambda: world.add(CUBE, name="crate"), "name", "crate", "taken", "2")


@pytest.mark.parametrize("groups", [3, [1], [None], ["g", 2.0], object(), [b"g"], None])
def test_what_is_no_group(world: World, groups: Any) -> None:
    refuses(lambda: world.add(CUBE, groups=groups), "groups", "expected", "name", error=TypeError)


@pytest.mark.parametrize("masks", ["", "on", "Path", "all"])
def test_unknown_masks(masks: str) -> None:
    refuses(lambda: World(masks=masks), "masks", f"'{masks}'", "path", "published", "off")


SCALARS: dict[str, Call] = {
    "name": lambda w, x: w.add(CUBE, name=x),
    "masks": lambda w, x: World(masks=x),
    "allowed": lambda w, x: w.allow(2, 3, x),
    "margin": lambda w, x: w.collides(2, HERE, margin=x),
    "tolerance": lambda w, x: w.check_motion(2, HERE, TWO, tolerance=x),
    "first_contact": lambda w, x: w.check_motion(2, HERE, TWO, first_contact=x),
    "max_distance": lambda w, x: w.raycast([0, 0, 0], [1, 0, 0], x),
    "resolution": lambda w, x: w.check_motion(2, HERE, TWO, mode="discrete", resolution=x),
    "mode": lambda w, x: w.check_motion(2, HERE, TWO, mode=x),
}


@pytest.mark.parametrize("name", SCALARS)
def test_scalars_of_a_wrong_type(world: World, name: str) -> None:
    for value in (b"x", 1j, [0.1, 0.2], object(), np.zeros(2)):
        with pytest.raises((TypeError, ValueError), match=name):
            SCALARS[name](world, value)


# Relations


def test_impossible_carriers(world: World) -> None:
    refuses(lambda: world.attach(2, 2), "carrier", "crate")
    refuses(lambda: world.attach("robot", "held"), "carrier", "held", "robot")
    refuses(lambda: world.attach("held", "crate"), "body", "held", "carried", "detach")
    refuses(lambda: world.detach("crate"), "body", "crate", "not carried")


def test_a_body_is_not_allowed_to_meet_itself(world: World) -> None:
    refuses(lambda: world.allow(2, "crate"), "allow", "crate")


def test_no_path_no_candidates(world: World) -> None:
    refuses(lambda: world.candidates("box"), "robot", "box", "set_path")
    refuses(lambda: world.motion_boxes("box"), "robot", "box", "set_path")
    world.clear_path("box")  # nothing to clear


def test_robots_named_twice(world: World) -> None:
    repeated: tuple[list[int | str], ...] = ([2, 2], ["crate", 3, 2])
    for robots in repeated:
        poses = np.tile(HERE, (len(robots), 1, 1))
        refuses(partial(world.check_motions, robots, poses, poses), "robots", "2", "twice")
    one: Any = 2
    refuses(lambda: world.check_motions(one, HERE, HERE), "robots", r"\(n,\)")
    refuses(lambda: world.check_motions([2, 3], HERE, np.stack([HERE] * 3)), "robots", "end")


# Poses, times

POSED: dict[str, tuple[str, Call]] = {
    "add": ("pose", lambda w, x: w.add(CUBE, x)),
    "set_pose": ("poses", lambda w, x: w.set_pose([2, 3, 4], x)),
    "set_path": ("poses", lambda w, x: w.set_path(2, x)),
    "set_trajectory": ("poses", lambda w, x: w.set_trajectory(2, [0.0, 1.0, 2.0], x)),
    "collides": ("poses", lambda w, x: w.collides(2, x)),
    "clearance": ("poses", lambda w, x: w.clearance(2, x)),
    "check_motion start": ("start", lambda w, x: w.check_motion(2, x, HERE)),
    "check_motion end": ("end", lambda w, x: w.check_motion(2, HERE, x)),
    "check_motions start": ("start", lambda w, x: w.check_motions([2, 3, 4], x, HERE)),
    "check_motions end": ("end", lambda w, x: w.check_motions([2, 3, 4], HERE, x)),
}


@pytest.mark.parametrize("call", POSED)
def test_bad_poses(world: World, call: str) -> None:
    name, ask = POSED[call]
    for case, (value, error, words) in BAD_POSES.items():
        if case != "None" or call != "add":  # default: identity
            refuses(partial(ask, world, value), rf"\b{name}\b", *words, error=error)


def test_poses_that_do_not_fit(world: World) -> None:
    refuses(lambda: world.add(CUBE, TWO), "pose", r"\(2,\)", "one")
    refuses(lambda: world.set_pose([2, 3, 4], TWO), "ids", r"\(3,\)", "poses", r"\(2,\)")
    refuses(lambda: world.set_pose(2, TWO), "poses", r"\(2,\)")
    refuses(lambda: world.set_pose([2], TWO), "poses", r"\(2,\)")
    refuses(lambda: world.set_path(2, HERE), "poses", r"\(K, 4, 4\)")
    refuses(lambda: world.set_path(2, TWO[:0]), "poses", "at least 1")
    refuses(lambda: world.set_path(2, TWO[None]), "poses", r"\(1, 2\)")
    refuses(lambda: world.check_motion(2, TWO, np.stack([HERE] * 3)), "start", "end", "broadcast")


BAD_TIMES: dict[str, tuple[Any, Any, tuple[str, ...]]] = {
    "falling": ([1.0, 0.0], TWO, (r"times\[1\]", "after")),
    "equal": ([1.0, 1.0], TWO, (r"times\[1\]", "after")),
    "NaN": ([0.0, np.nan], TWO, ("times", "finite")),
    "infinite": ([0.0, np.inf], TWO, ("times", "finite")),
    "too few": ([0.0], TWO, ("times", r"\(1,\)", r"\(2,\)")),
    "too many": ([0.0, 1.0, 2.0], TWO, ("times", r"\(3,\)", r"\(2,\)")),
    "a number": (0.0, TWO, ("times", r"\(\)", r"\(k,\)")),
    "a number and a pose": (0.0, HERE, ("times", r"\(\)", r"\(k,\)")),
    "none at all": ([], TWO[:0], ("times", "at least 1")),
    "square": ([[0.0, 1.0]], TWO[None], ("times", r"\(1, 2\)")),
    "text": (["a", "b"], TWO, ("times", "float64")),
    "None, with poses": (None, TWO, ("times",)),
    "without poses": ([0.0, 1.0], None, ("poses",)),
}


@pytest.mark.parametrize("case", BAD_TIMES)
def test_bad_trajectories(world: World, case: str) -> None:
    times, poses, words = BAD_TIMES[case]
    refuses(lambda: world.set_trajectory("door", times, poses), *words)


@pytest.mark.parametrize("call", ["collides", "clearance"])
def test_bad_times_of_queries(world: World, call: str) -> None:
    ask = getattr(world, call)
    refuses(lambda: ask(2, TWO, times=[0.0, np.nan]), "times", "finite")
    refuses(lambda: ask(2, TWO, times=[0.0, 1.0, 2.0]), "times", r"\(3,\)", "broadcast")
    refuses(lambda: ask(2, TWO, times="now"), "times", "float64")
    refuses(lambda: ask(2, TWO, times=[[0.0], [1.0, 2.0]]), "times")


@pytest.mark.parametrize(
    "window",
    [(0.0, None), (None, 1.0), (1.0, 0.0), (np.nan, 1.0), (0.0, np.inf), ("a", 1.0), ([0.0], 1.0)],
)
def test_bad_windows(world: World, window: tuple[Any, Any]) -> None:
    t0, t1 = window
    refuses(
        lambda: world.check_motion(2, HERE, TWO, start_time=t0, end_time=t1),
        "start_time",
        "end_time",
        "seconds",
    )
    refuses(
        lambda: world.check_motions([2], HERE, HERE, start_time=t0, end_time=t1),
        "start_time",
        "end_time",
        "seconds",
    )


# Numbers

METERS: dict[str, tuple[str, Call]] = {
    "collides": ("margin", lambda w, x: w.collides(2, HERE, margin=x)),
    "check_motion": ("margin", lambda w, x: w.check_motion(2, HERE, HERE, margin=x)),
    "check_motions": ("margin", lambda w, x: w.check_motions([2], HERE, HERE, margin=x)),
    "contacts": ("margin", lambda w, x: w.contact_pairs(margin=x)),
    "tolerance": ("tolerance", lambda w, x: w.check_motion(2, HERE, HERE, tolerance=x)),
    "tolerance of many": ("tolerance", lambda w, x: w.check_motions([2], HERE, HERE, tolerance=x)),
    "resolution": (
        "resolution",
        lambda w, x: w.check_motion(2, HERE, HERE, mode="discrete", resolution=x),
    ),
}


@pytest.mark.parametrize("call", METERS)
def test_bad_meters(world: World, call: str) -> None:
    name, ask = METERS[call]
    for value in (-1e-9, -1.0, np.nan, np.inf, -np.inf):
        refuses(partial(ask, world, value), name, "meters", error=ValueError)


@pytest.mark.parametrize("call", ["tolerance", "tolerance of many", "resolution"])
def test_meters_over_zero(world: World, call: str) -> None:
    name, ask = METERS[call]
    refuses(lambda: ask(world, 0.0), name, "above 0", error=ValueError)


@pytest.mark.parametrize("threads", [0, -1, 10**9, 1.5, "all", [2]])
def test_bad_threads(world: World, threads: Any) -> None:
    for call in (
        lambda: world.collides(2, TWO, threads=threads),
        lambda: world.clearance(2, TWO, threads=threads),
        lambda: world.check_motion(2, HERE, TWO, threads=threads),
        lambda: world.contact_pairs(threads=threads),
        lambda: world.raycast([0, 0, 0], [1, 0, 0], threads=threads),
    ):
        refuses(call, "threads")


@pytest.mark.parametrize("mode", ["fast", "", "Continuous", None, 3])
def test_unknown_modes(world: World, mode: Any) -> None:
    refuses(lambda: world.check_motion(2, HERE, TWO, mode=mode), "mode", "continuous", "discrete")


def test_resolution_belongs_to_discrete(world: World) -> None:
    refuses(lambda: world.check_motion(2, HERE, TWO, resolution=0.1), "resolution", "discrete")
    refuses(lambda: world.check_motion(2, HERE, TWO, mode="discrete"), "resolution", "meters")


@pytest.mark.parametrize("case", BAD_POINTS)
def test_bad_rays(world: World, case: str) -> None:
    points, error, words = BAD_POINTS[case]
    refuses(lambda: world.raycast(points, [1, 0, 0]), "origins", *words, error=error)
    refuses(lambda: world.raycast([0, 0, 0], points), "directions", *words, error=error)


def test_rays_that_can_not_be(world: World) -> None:
    refuses(lambda: world.raycast(np.zeros((3, 3)), np.ones((2, 3))), "origins", "directions")
    refuses(lambda: world.raycast([0, 0, 0], [[1, 0, 0], [0, 0, 0]]), "directions", "1")
    for reach in (-1.0, np.nan, -np.inf):
        refuses(partial(world.raycast, [0, 0, 0], [1, 0, 0], reach), "max_distance")


# Atomic changes, and valid input


def test_one_bad_body_or_pose_moves_none(world: World) -> None:
    bad: tuple[Any, ...] = ([2, 3, 99], [2, 3, "held"], [2, 3, None])
    for ids in bad:
        refuses(partial(world.set_pose, ids, at(7.0)))
    broken = np.stack([at(7.0), at(8.0), np.full((4, 4), np.nan)])
    refuses(lambda: world.set_pose([2, 3, 4], broken), r"poses\[2\]")

    def fails() -> Any:
        yield 2
        raise KeyError("broken off")

    with pytest.raises(KeyError, match="broken off"):
        world.set_pose(fails(), at(7.0))


def test_odd_but_fine() -> None:
    world = furnished()
    world.set_pose(np.array(2, np.int8), at(3.0).astype(np.float32))
    world.set_pose([2, 2], np.stack([at(5.0), at(9.0)]))  # the last of two poses counts
    assert world.poses(2)[0, 3] == 9.0
    assert world.add(CUBE, at(100.0).tolist(), name="\N{WARNING SIGN} \0 x") == 5
    assert world.record("\N{WARNING SIGN} \0 x").id == 5
    world.allow(2, 3)
    world.allow(2, 3)
    world.allow(2, 3, False)
    world.allow(2, 3, False)
    world.allow_groups("never heard of", "g", False)
    assert world.check_motion(2, HERE, HERE, margin=0, tolerance=1).free
    assert world.collides(2, HERE, times=-0.0) is False
    assert world.raycast([0, 0, 0], [1e-300, 0, 0], np.inf).body >= 0
    assert world.raycast([0.1, 0.2, 0.3], [1, 0, 0], 0.0).body == -1


# Arbitrary arguments

ANYTHING = st.one_of(
    ANY_ARRAY,
    st.integers(-5, 9),
    st.sampled_from(["crate", "robot", "held", "", None, True, 2.5, CUBE, Shape, b"x", 2**70]),
    st.lists(st.sampled_from([0, 1, 2, 3, 4, 9, "crate", "held", None, 2.0]), max_size=4),
    st.sampled_from([HERE, TWO, TWO[0], at(6.0), np.stack([TWO, TWO])]),
)
METHODS = [
    *("add", "remove", "set_pose", "poses", "attach", "detach", "allow", "allow_groups"),
    *("set_trajectory", "set_path", "clear_path", "candidates", "motion_boxes", "mask", "own_bit"),
    *("collides", "clearance", "check_motion", "check_motions", "raycast", "record"),
]
KEYWORDS = {
    "add": ("name", "groups"),
    "collides": ("times", "margin", "threads"),
    "clearance": ("times", "threads"),
    "check_motion": (
        "margin",
        "tolerance",
        "mode",
        "first_contact",
        "start_time",
        "end_time",
        "threads",
    ),
    "check_motions": ("margin", "tolerance", "start_time", "end_time"),
    "raycast": ("max_distance", "ignore", "threads"),
}


@settings(max_examples=150)
@given(st.data())
def test_anything_gives_an_answer_or_an_error(data: st.DataObject) -> None:
    world = furnished()
    for _ in range(3):
        method = data.draw(st.sampled_from(METHODS))
        arguments = data.draw(st.lists(ANYTHING, min_size=1, max_size=3))
        some = data.draw(st.sets(st.sampled_from(KEYWORDS.get(method, ("",))), max_size=2))
        keywords: dict[str, Any] = {name: data.draw(ANYTHING) for name in sorted(some) if name}
        if isinstance(keywords.get("threads"), int):
            keywords["threads"] = min(keywords["threads"], 4)
        try:
            getattr(world, method)(*arguments, **keywords)
        except (TypeError, ValueError, RuntimeError):
            continue
    ids = world.ids.tolist()
    assert len(world.names) == len(world) == len(ids)
    for body in ids:
        assert np.isfinite(world.record(body).pose).all()
        world.mask(body)
    world.contact_pairs()
    world.copy()


def test_a_world_lets_go_of_its_shapes() -> None:
    """Shapes are released with the world, with their bodies, and after errors."""
    shape = Shape(*box(1.0))
    before = sys.getrefcount(shape)
    for _ in range(20):
        world = World()
        for i in range(5):
            world.add(shape, at(3.0 * i), name=f"{i}")
        world.attach(1, 0)
        world.remove(0)
        refuses(partial(world.add, shape, name="1"), "name")
        refuses(partial(world.add, shape, np.zeros((4, 4))), "pose")
        assert world.copy().record(2).shape is shape
    del world
    gc.collect()
    assert sys.getrefcount(shape) == before
