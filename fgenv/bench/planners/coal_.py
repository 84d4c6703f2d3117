"""Free bodies in coal."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import coal

from fgenv.arrays import Floats
from fgenv.bench.peers.coal_ import PEER

from .rigid import Bind, Collides, any_collision, fastest
from .task import Task, merged


def coal_bodies(task: Task) -> Bind:
    """Return coal's model of a task."""
    request, result = coal.CollisionRequest(), coal.CollisionResult()
    collide, callback = coal.collide, coal.CollisionCallBackDefault()
    movers = [PEER.build(mesh) for mesh in task.movers]
    whole, origin = PEER.build(merged(task.obstacles)), coal.Transform3s()
    tree, objects = coal.DynamicAABBTreeCollisionManager(), []
    for mesh in task.obstacles:
        objects.append(coal.CollisionObject(PEER.build(mesh), origin))
        objects[-1].computeAABB()
        tree.registerObject(objects[-1])
    tree.setup()

    def in_tree(body: Any) -> bool:
        body[0].setTransform(body[1])
        body[0].computeAABB()
        callback.data.clear()
        tree.collide(body[0], callback)
        return bool(callback.data.result.isCollision())

    def in_whole(body: Any) -> bool:
        result.clear()
        return bool(collide(body[2], body[1], whole, origin, request, result))

    def in_other(a: Any, b: Any) -> bool:
        result.clear()
        return bool(collide(a[2], a[1], b[2], b[1], request, result))

    def model(hits_obstacle: Callable[[Any], bool]) -> Bind:
        def bind(row: Floats) -> Collides:
            bodies = [(coal.CollisionObject(m), coal.Transform3s(), m) for m in movers]
            moves = [coal_move(body[1], row[7 * i :]) for i, body in enumerate(bodies)]
            return any_collision(moves, bodies, hits_obstacle, in_other)

        return bind

    bind = fastest(task.name, task.samples, [model(in_tree), model(in_whole)])
    bind.objects = objects  # type: ignore[attr-defined]  # the manager does not own its bodies
    return bind


def coal_move(transform: Any, row: Floats) -> Callable[[], None]:
    """Return a function that sets a transform to the pose in a row."""
    set_position, set_rotation = transform.setTranslation, transform.setQuatRotation
    position, quaternion = row[:3], row[3:7]

    def move() -> None:
        set_position(position)
        set_rotation(coal.Quaternion(quaternion))

    return move
