"""Free bodies in python-fcl."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import fcl

from fgenv.arrays import Floats
from fgenv.bench.peers.fcl_ import PEER

from .rigid import Bind, Collides, any_collision, fastest
from .task import Task, merged


def fcl_bodies(task: Task) -> Bind:
    """Return python-fcl's model of a task."""
    request, collide = fcl.CollisionRequest(), fcl.collide
    movers = [PEER.build(mesh) for mesh in task.movers]
    whole = fcl.CollisionObject(PEER.build(merged(task.obstacles)))
    tree = fcl.DynamicAABBTreeCollisionManager()
    tree.registerObjects([fcl.CollisionObject(PEER.build(mesh)) for mesh in task.obstacles])
    tree.setup()

    def callback(a: Any, b: Any, hit: list[bool]) -> bool:
        hit[0] = collide(a, b, request) > 0
        return hit[0]

    def in_tree(body: Any) -> bool:
        hit = [False]
        tree.collide(body, hit, callback)
        return hit[0]

    def in_whole(body: Any) -> bool:
        return bool(collide(body, whole, request))

    def model(hits_obstacle: Callable[[Any], bool]) -> Bind:
        def bind(row: Floats) -> Collides:
            bodies = [fcl.CollisionObject(m) for m in movers]
            moves = [fcl_move(body, row[7 * i :]) for i, body in enumerate(bodies)]
            return any_collision(moves, bodies, hits_obstacle, lambda a, b: collide(a, b, request))

        return bind

    return fastest(task.name, task.samples, [model(in_tree), model(in_whole)])


def fcl_move(body: Any, row: Floats) -> Callable[[], None]:
    """Return a function that sets a body to the pose in a row.

    FCL's quaternions have w first, so w is copied before the other three components.
    """
    set_position, set_rotation = body.setTranslation, body.setQuatRotation
    position, quaternion = row[:3], row[2:6]

    def move() -> None:
        set_position(position)
        row[2] = row[6]
        set_rotation(quaternion)

    return move
