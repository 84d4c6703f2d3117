"""All colliding pairs among many bodies, through the Python interface of each library."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any, Protocol

import numpy as np

from fgenv.arrays import Poses
from fgenv.bench.common.meshes import Mesh

Pairs = set[tuple[int, int]]  # indices of bodies, ascending


class Bodies(Protocol):
    """Bodies of one mesh in one library."""

    def step(self, poses: Poses) -> object:
        """Move all bodies to poses (n, 4, 4) and find all colliding pairs; this is timed."""

    def pairs(self, poses: Poses) -> Pairs:
        """Return these pairs in a form to compare."""


@dataclass(frozen=True)
class Manager:
    """The manager of many bodies in a library; `truth`: the subject of its verdicts."""

    name: str
    needs: str  # module
    truth: str
    make: Callable[[Mesh, Poses], Bodies]


class FgenvBodies:
    """`set_pose` of all, `contact_pairs`, one thread."""

    def __init__(self, mesh: Mesh, poses: Poses) -> None:
        from fgenv.bench.peers.fgenv_ import PEER
        from fgenv.collision import World

        self.shape = PEER.build(mesh)
        self.world = World()
        self.ids = np.array([self.world.add(self.shape, pose) for pose in poses])

    def step(self, poses: Poses) -> object:
        self.world.set_pose(self.ids, poses)
        return self.world.contact_pairs(threads=1)

    def pairs(self, poses: Poses) -> Pairs:
        self.world.set_pose(self.ids, poses)
        index = {int(body): k for k, body in enumerate(self.ids)}
        return {(index[int(a)], index[int(b)]) for a, b in self.world.contact_pairs(threads=1)}


class FclBodies:
    """DynamicAABBTreeCollisionManager; a callback checks each pair and counts collisions."""

    def __init__(self, mesh: Mesh, poses: Poses) -> None:
        import fcl

        from fgenv.bench.peers.fcl_ import PEER

        self.fcl, model = fcl, PEER.build(mesh)
        self.objects = [
            fcl.CollisionObject(model, fcl.Transform(T[:3, :3], T[:3, 3])) for T in poses
        ]
        self.manager = fcl.DynamicAABBTreeCollisionManager()
        self.manager.registerObjects(self.objects)
        self.manager.setup()
        self.request = fcl.CollisionRequest()

    def place(self, poses: Poses) -> None:
        make = self.fcl.Transform
        for body, turn, shift in zip(self.objects, poses[:, :3, :3], poses[:, :3, 3], strict=True):
            body.setTransform(make(turn, shift))
        self.manager.update()

    def step(self, poses: Poses) -> object:
        self.place(poses)
        collide, request = self.fcl.collide, self.request

        def callback(a: Any, b: Any, count: list[int]) -> bool:
            if collide(a, b, request):
                count[0] += 1
            return False

        count = [0]
        self.manager.collide(count, callback)
        return count[0]

    def pairs(self, poses: Poses) -> Pairs:
        """Bodies that share a model are distinguished by their poses."""
        self.place(poses)
        index = {body.getTranslation().tobytes(): k for k, body in enumerate(self.objects)}
        hits: Pairs = set()

        def callback(a: Any, b: Any, _: object) -> bool:
            if self.fcl.collide(a, b, self.request):
                i, j = (index[body.getTranslation().tobytes()] for body in (a, b))
                hits.add((min(i, j), max(i, j)))
            return False

        self.manager.collide(None, callback)
        return hits


class CoalBodies:
    """DynamicAABBTreeCollisionManager; pairs come from all contacts of all pairs.

    coal's Python interface has neither callbacks nor the pairs that the manager collects. Models
    are distinguished by their addresses.
    """

    def __init__(self, mesh: Mesh, poses: Poses) -> None:
        import coal

        from fgenv.bench.peers.coal_ import PEER

        model = PEER.build(mesh)
        self.models = [model.clone() for _ in poses]
        self.objects = [coal.CollisionObject(model) for model in self.models]
        self.manager = coal.DynamicAABBTreeCollisionManager()
        for body, T in zip(self.objects, poses, strict=True):
            body.setTransform(coal.Transform3s(T[:3, :3], T[:3, 3]))
            body.computeAABB()
            self.manager.registerObject(body)
        self.manager.setup()
        self.make = coal.Transform3s
        self.callback = coal.CollisionCallBackDefault()
        self.callback.data.request.num_max_contacts = 10**9

    def step(self, poses: Poses) -> Any:
        make = self.make
        for body, turn, shift in zip(self.objects, poses[:, :3, :3], poses[:, :3, 3], strict=True):
            body.setTransform(make(turn, shift))
            body.computeAABB()
        self.manager.update()
        self.callback.data.clear()
        self.callback.data.request.num_max_contacts = 10**9
        self.manager.collide(self.callback)
        return self.callback.data.result

    def pairs(self, poses: Poses) -> Pairs:
        index = {model.id(): k for k, model in enumerate(self.models)}
        pairs = [(index[c.o1.id()], index[c.o2.id()]) for c in self.step(poses).getContacts()]
        return {(min(pair), max(pair)) for pair in pairs}


class TrimeshBodies:
    """CollisionManager (python-fcl below): `set_transform` of all, `in_collision_internal`."""

    def __init__(self, mesh: Mesh, poses: Poses) -> None:
        import trimesh

        body = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
        self.manager = trimesh.collision.CollisionManager()
        for k, pose in enumerate(poses):
            self.manager.add_object(str(k), body, pose)
        self.names = [str(k) for k in range(len(poses))]

    def step(self, poses: Poses) -> Any:
        for name, pose in zip(self.names, poses, strict=True):
            self.manager.set_transform(name, pose)
        return self.manager.in_collision_internal(return_names=True)[1]

    def pairs(self, poses: Poses) -> Pairs:
        pairs = [(int(a), int(b)) for a, b in self.step(poses)]
        return {(min(pair), max(pair)) for pair in pairs}


class MujocoBodies:
    """Free bodies: `mj_kinematics`, `mj_collision`. Hulls for meshes."""

    def __init__(self, mesh: Mesh, poses: Poses) -> None:
        import mujoco

        self.mujoco, spec = mujoco, mujoco.MjSpec()
        asset = spec.add_mesh(name="mesh", inertia=mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL)
        asset.uservert, asset.userface = mesh.vertices.ravel(), mesh.faces.ravel()
        for k in range(len(poses)):
            body = spec.worldbody.add_body(name=str(k))
            body.add_freejoint()
            body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="mesh")
        spec.memory = (1 << 20) + 40_000 * len(poses) + 4 * len(poses) ** 2  # contacts, sorting
        self.model = spec.compile()
        self.data = mujoco.MjData(self.model)

    def step(self, poses: Poses) -> Any:
        joints = self.data.qpos.reshape(-1, 7)
        joints[:, :3] = poses[:, :3, 3]
        joints[:, 3:] = quaternions(poses[:, :3, :3])
        self.mujoco.mj_kinematics(self.model, self.data)
        self.mujoco.mj_collision(self.model, self.data)
        return self.data.contact.geom

    def pairs(self, poses: Poses) -> Pairs:
        pairs = np.sort(self.step(poses), axis=1)
        return {(int(a), int(b)) for a, b in pairs}


def quaternions(turns: Poses) -> Poses:
    """Return quaternions (n, 4), w first, of rotations (n, 3, 3).

    The result is the longest column of the product of the quaternion with its transpose.
    """
    t = turns
    a, b, c = t[:, 2, 1], t[:, 0, 2], t[:, 1, 0]
    d, e, f = t[:, 1, 2], t[:, 2, 0], t[:, 0, 1]
    x, y, z = t[:, 0, 0], t[:, 1, 1], t[:, 2, 2]
    rows = [
        [1 + x + y + z, a - d, b - e, c - f],
        [a - d, 1 + x - y - z, c + f, b + e],
        [b - e, c + f, 1 - x + y - z, a + d],
        [c - f, b + e, a + d, 1 - x - y + z],
    ]
    dyad = np.moveaxis(np.array(rows), 2, 0)
    longest = dyad[np.arange(len(t)), np.diagonal(dyad, axis1=1, axis2=2).argmax(axis=1)]
    return np.asarray(longest / np.linalg.norm(longest, axis=1, keepdims=True))


MANAGERS = (
    Manager("fgenv", "fgenv", "meshes", FgenvBodies),
    Manager("python-fcl", "fcl", "meshes", FclBodies),
    Manager("coal", "coal", "meshes", CoalBodies),
    Manager("trimesh", "fcl", "meshes", TrimeshBodies),
    Manager("mujoco", "mujoco", "hulls", MujocoBodies),
)


def managers() -> list[Manager]:
    """The managers with an installed library, fgenv first."""
    return [manager for manager in MANAGERS if find_spec(manager.needs) is not None]
