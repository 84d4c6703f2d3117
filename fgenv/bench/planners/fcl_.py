"""Free bodies in python-fcl."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fgenv.arrays import Floats

from .rigid import Bind, Collides, faster, joined
from .task import Task, Triangles, merged


def fcl_bodies(task: Task) -> Bind:
    """python-fcl's form of a task."""
    import fcl

    def model(mesh: Triangles) -> Any:
        made = fcl.BVHModel()
        made.beginModel(len(mesh.vertices), len(mesh.faces))
        made.addSubModel(mesh.vertices, mesh.faces)
        made.endModel()
        return made

    request, meet = fcl.CollisionRequest(), fcl.collide
    movers = [model(mesh) for mesh in task.movers]
    whole = fcl.CollisionObject(model(merged(task.standing)))
    tree = fcl.DynamicAABBTreeCollisionManager()
    tree.registerObjects([fcl.CollisionObject(model(mesh)) for mesh in task.standing])
    tree.setup()

    def met(a: Any, b: Any, found: list[bool]) -> bool:
        found[0] = meet(a, b, request) > 0
        return found[0]

    def in_tree(body: Any) -> bool:
        found = [False]
        tree.collide(body, found, met)
        return found[0]

    def in_whole(body: Any) -> bool:
        return bool(meet(body, whole, request))

    def bind(row: Floats, meets: Callable[[Any], bool]) -> Collides:
        bodies = [fcl.CollisionObject(m) for m in movers]
        moves = [fcl_move(body, row[7 * i :]) for i, body in enumerate(bodies)]
        return joined(moves, bodies, meets, lambda a, b: meet(a, b, request))

    return faster(
        task.name, task.samples, [lambda row: bind(row, in_tree), lambda row: bind(row, in_whole)]
    )


def fcl_move(body: Any, row: Floats) -> Callable[[], None]:
    """Places a body where a row says; it wants w first, so w goes before the other three."""
    place, turn, at, quaternion = body.setTranslation, body.setQuatRotation, row[:3], row[2:6]

    def move() -> None:
        place(at)
        row[2] = row[6]
        turn(quaternion)

    return move
