"""Free bodies in coal."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fgenv.arrays import Floats

from .rigid import Bind, Collides, faster, joined
from .task import Task, Triangles, merged


def coal_model(mesh: Triangles) -> Any:
    """coal's mesh, as robots' libraries build it."""
    from coal import BVHModelOBBRSS

    made = BVHModelOBBRSS()
    made.beginModel(len(mesh.faces), len(mesh.vertices))
    made.addVertices(mesh.vertices)
    made.addTriangles(mesh.faces.astype(np.uint32))
    made.endModel()
    return made


def coal_bodies(task: Task) -> Bind:
    """coal's form of a task."""
    import coal

    request, result = coal.CollisionRequest(), coal.CollisionResult()
    meet, answer = coal.collide, coal.CollisionCallBackDefault()
    movers = [coal_model(mesh) for mesh in task.movers]
    whole, here = coal_model(merged(task.standing)), coal.Transform3s()
    tree, held = coal.DynamicAABBTreeCollisionManager(), []
    for mesh in task.standing:
        held.append(coal.CollisionObject(coal_model(mesh), here))
        held[-1].computeAABB()
        tree.registerObject(held[-1])
    tree.setup()

    def in_tree(body: Any) -> bool:
        body[0].setTransform(body[1])
        body[0].computeAABB()
        answer.data.clear()
        tree.collide(body[0], answer)
        return bool(answer.data.result.isCollision())

    def in_whole(body: Any) -> bool:
        result.clear()
        return bool(meet(body[2], body[1], whole, here, request, result))

    def in_each_other(a: Any, b: Any) -> bool:
        result.clear()
        return bool(meet(a[2], a[1], b[2], b[1], request, result))

    def bind(row: Floats, meets: Callable[[Any], bool]) -> Collides:
        bodies = [(coal.CollisionObject(m), coal.Transform3s(), m) for m in movers]
        moves = [coal_move(body[1], row[7 * i :]) for i, body in enumerate(bodies)]
        return joined(moves, bodies, meets, in_each_other)

    bound = faster(
        task.name, task.samples, [lambda row: bind(row, in_tree), lambda row: bind(row, in_whole)]
    )
    bound.held = held  # type: ignore[attr-defined]  # the manager keeps no hold on its bodies
    return bound


def coal_move(pose: Any, row: Floats) -> Callable[[], None]:
    """Sets a transform to what a row says."""
    from coal import Quaternion

    place, turn, at, quaternion = pose.setTranslation, pose.setQuatRotation, row[:3], row[3:7]

    def move() -> None:
        place(at)
        turn(Quaternion(quaternion))

    return move
