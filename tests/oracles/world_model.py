"""Random worlds, and a simple model of a world: tests of every pair, motions by samples."""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cache

import numpy as np
from scipy.spatial.transform import Rotation
from support.meshes import pairs

from fgenv.arrays import Flags, Floats
from fgenv.bench.common.poses import random_rotations
from fgenv.bench.common.solids import angle_iron, ball, box, opened, somewhere, turned
from fgenv.collision import Shape, collide, distance
from fgenv.collision.world import World


@cache
def shapes() -> tuple[Shape, ...]:
    """Bodies of about half a meter: solid and open, convex and not, and two real ones."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        made = [box(0.5), ball(0.3), angle_iron(0.6, 0.15, 0.4), opened(box(0.5, 0.4, 0.3))]
        for pair in pairs(2, largest=1000, seed=21):
            mesh = pair.load()[0]
            made.append((mesh.vertices * (0.6 / mesh.size), mesh.faces.astype(np.int64)))
        return tuple(Shape(*solid) for solid in made)


def along(T0: Floats, T1: Floats, t: Floats) -> Floats:
    """Poses (n, 4, 4) at fractions t (n,) of motions from T0 to T1, one or n of them.

    Position is linear, orientation takes the shortest arc from T0's.
    """
    T0, T1 = np.broadcast_to(T0, (len(t), 4, 4)), np.broadcast_to(T1, (len(t), 4, 4))
    out = np.tile(np.eye(4), (len(t), 1, 1))
    out[:, :3, 3] = T0[:, :3, 3] + t[:, None] * (T1 - T0)[:, :3, 3]
    if len(t):
        turn = Rotation.from_matrix(T1[:, :3, :3] @ T0[:, :3, :3].transpose(0, 2, 1)).as_rotvec()
        out[:, :3, :3] = Rotation.from_rotvec(t[:, None] * turn).as_matrix() @ T0[:, :3, :3]
    return out


def nudged(rng: np.random.Generator, pose: Floats, reach: float, turn: float = 1.0) -> Floats:
    """The pose moved by about `reach` meters and turned by about `turn` radians."""
    out = pose @ turned(rng.normal() * turn, tuple(rng.normal(size=3)))
    out[:3, 3] = pose[:3, 3] + rng.normal(size=3) * reach
    return out


@dataclass
class Item:
    """A body of the model."""

    shape: Shape
    pose: Floats
    groups: set[str] = field(default_factory=set)
    allowed: set[int] = field(default_factory=set)
    carrier: int | None = None
    offset: Floats = field(default_factory=lambda: np.eye(4))  # in the root's frame
    times: Floats | None = None
    poses: Floats | None = None


class Model:
    """Reference results of a World by testing every pair, with the World's method names."""

    def __init__(self) -> None:
        self.items: dict[int, Item] = {}
        self.groups: set[tuple[str, str]] = set()

    # Changes

    def add(self, body: int, shape: Shape, pose: Floats, groups: Iterable[str] = ()) -> None:
        self.items[body] = Item(shape, pose.copy(), set(groups))

    def remove(self, body: int) -> None:
        for part in [p for p, item in self.items.items() if item.carrier == body]:
            self.detach(part)
        del self.items[body]
        for item in self.items.values():
            item.allowed.discard(body)

    def set_pose(self, body: int, pose: Floats) -> None:
        for part in self.parts(body):
            self.items[part].pose = pose @ self.items[part].offset

    def attach(self, body: int, carrier: int) -> None:
        family = self.parts(body)
        self.items[body].times = None
        self.items[body].carrier = carrier
        self._measure(family, self.root(carrier))

    def detach(self, body: int) -> None:
        self.items[body].carrier = None
        self._measure(self.parts(body), body)

    def _measure(self, family: list[int], root: int) -> None:
        for part in family:
            self.items[part].offset = np.linalg.inv(self.items[root].pose) @ self.items[part].pose

    def allow(self, a: int, b: int, allowed: bool = True) -> None:
        for one, other in ((a, b), (b, a)):
            (self.items[one].allowed.add if allowed else self.items[one].allowed.discard)(other)

    def allow_groups(self, a: str, b: str, allowed: bool = True) -> None:
        for pair in ((a, b), (b, a)):
            (self.groups.add if allowed else self.groups.discard)(pair)

    def set_trajectory(self, body: int, times: Floats | None, poses: Floats | None) -> None:
        self.items[body].times, self.items[body].poses = times, poses

    # Roles of bodies

    def root(self, body: int) -> int:
        carrier = self.items[body].carrier
        return body if carrier is None else self.root(carrier)

    def parts(self, root: int) -> list[int]:
        """The body and all bodies that it carries."""
        found = [root]
        for one in found:
            found += [p for p, item in self.items.items() if item.carrier == one]
        return found

    @property
    def roots(self) -> list[int]:
        return [body for body, item in self.items.items() if item.carrier is None]

    def ignores(self, a: int, b: int) -> bool:
        one, other = self.items[a], self.items[b]
        grouped = any(pair in self.groups for pair in itertools.product(one.groups, other.groups))
        return self.root(a) == self.root(b) or b in one.allowed or grouped

    def pairs(self, robot: int) -> Iterator[tuple[int, int]]:
        """Pairs (part of the robot, other body) that must not touch."""
        for part, other in itertools.product(self.parts(robot), self.items):
            if not self.ignores(part, other):
                yield part, other

    def pose(self, body: int, times: Floats | None = None) -> Floats:
        """Pose of a body: (4, 4) now, or (n, 4, 4) at times (n,)."""
        item, root = self.items[body], self.items[self.root(body)]
        if times is None or root.times is None:
            return item.pose
        assert root.poses is not None
        out = np.empty((len(times), 4, 4))
        leg = np.clip(np.searchsorted(root.times, times, "right") - 1, 0, len(root.times) - 1)
        for i in np.unique(leg):
            j = min(i + 1, len(root.times) - 1)
            length = root.times[j] - root.times[i] if j > i else 1.0
            share = np.clip((times[leg == i] - root.times[i]) / length, 0.0, 1.0)
            out[leg == i] = along(root.poses[i], root.poses[j], share)
        return out if item is root else out @ item.offset

    # Queries

    def hits(
        self, robot: int, poses: Floats, times: Floats | None = None, margin: float = 0.0
    ) -> dict[int, Flags]:
        """Per body: flags of the robot's poses (n, 4, 4) at which the two collide."""
        found: dict[int, Flags] = {}
        for part, other in self.pairs(robot):
            item, there = self.items[part], self.pose(other, times)
            hit = collide(
                item.shape,
                poses if part == robot else poses @ item.offset,
                self.items[other].shape,
                there,
                margin=margin,
                threads=1,
            )
            found[other] = found.get(other, False) | hit
        return found

    def collides(
        self, robot: int, poses: Floats, times: Floats | None = None, margin: float = 0.0
    ) -> Flags:
        hit = np.zeros(len(poses), np.bool_)
        for found in self.hits(robot, poses, times, margin).values():
            hit |= found
        return hit

    def distances(
        self, robot: int, poses: Floats, times: Floats | None = None
    ) -> dict[int, Floats]:
        """Per body: its distance from the robot at poses (n, 4, 4)."""
        found: dict[int, Floats] = {}
        for part, other in self.pairs(robot):
            item, there = self.items[part], self.pose(other, times)
            place = poses if part == robot else poses @ item.offset
            apart = distance(item.shape, place, self.items[other].shape, there, threads=1)
            found[other] = np.minimum(found.get(other, np.inf), apart)
        return found

    def contacts(self, margin: float = 0.0) -> list[list[int]]:
        found = []
        for a, b in itertools.combinations(sorted(self.items), 2):
            one, other = self.items[a], self.items[b]
            if not self.ignores(a, b) and collide(
                one.shape, one.pose, other.shape, other.pose, margin=margin
            ):
                found.append([a, b])
        return found


def scatter(
    rng: np.random.Generator, count: int, reach: float, masks: str = "path"
) -> tuple[World, Model]:
    """A world of bodies at random within about `reach` meters, and its model."""
    world, model = World(masks=masks), Model()
    pool = shapes()
    for _ in range(count):
        shape, pose = pool[rng.integers(len(pool))], somewhere(rng, reach)
        model.add(world.add(shape, pose), shape, pose)
    return world, model


def carry(world: World, model: Model, body: int, carrier: int) -> None:
    """Attach in both."""
    world.attach(body, carrier)
    model.attach(body, carrier)


def wander(rng: np.random.Generator, count: int, reach: float) -> Floats:
    """Poses (count, 4, 4) at random, within about `reach` meters."""
    out = np.tile(np.eye(4), (count, 1, 1))
    out[:, :3, :3] = random_rotations(rng, count)
    out[:, :3, 3] = rng.normal(size=(count, 3)) * reach
    return out
