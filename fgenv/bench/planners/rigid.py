"""Free bodies in python-fcl and in coal, as a careful user writes a checker in Python.

Models are built once. A state's numbers come by OMPL's `serialize` straight into an array whose
views are what the libraries take: no other way of reading a state was faster. All that stands is
either one merged mesh or a tree of boxes over bodies, whichever is faster on the problem at hand.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import combinations
from time import process_time
from typing import Any

import numpy as np

from .task import Floats, Task, Triangles, merged

Collides = Callable[[], bool]  # of the configuration in the row that was bound
Bind = Callable[[Floats], Collides]  # to a row (7 n,): x, y, z, qx, qy, qz, qw of each robot
TRIAL = 300  # configurations


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


def joined(
    moves: list[Callable[[], None]],
    bodies: list[Any],
    meets: Callable[[Any], bool],
    each_other: Callable[[Any, Any], Any],
) -> Collides:
    """Whether any robot meets what stands, or two of them each other; the first yes ends it."""
    if len(bodies) == 1:
        move, body = moves[0], bodies[0]

        def alone() -> bool:
            move()
            return meets(body)

        return alone
    pairs, placed = list(combinations(bodies, 2)), list(zip(moves, bodies, strict=True))

    def together() -> bool:
        for move, body in placed:
            move()
            if meets(body):
                return True
        return any(each_other(a, b) for a, b in pairs)

    return together


def faster(name: str, samples: Floats, ways: list[Bind]) -> Bind:
    """The one that takes least CPU on configurations at random; all must say the same."""
    seconds, said = [], []
    for way in ways:
        row = np.empty(samples.shape[1])
        collides = way(row)
        runs = []
        for _ in range(3):
            began = process_time()
            said.append(asked(collides, row, samples[:TRIAL]))
            runs.append(process_time() - began)
        seconds.append(min(runs))
    if any(answers != said[0] for answers in said):
        raise RuntimeError(f"{name}: two forms of the same scene differ")
    return ways[int(np.argmin(seconds))]


def asked(collides: Collides, row: Floats, configurations: Floats) -> list[bool]:
    """What each configuration's answer is."""
    answers = []
    for q in configurations:
        row[:] = q
        answers.append(collides())
    return answers
