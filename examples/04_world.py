"""A world of crates: a mask per robot, certified motions, a door that opens."""

from itertools import pairwise

import numpy as np
import trimesh
from numpy.typing import NDArray
from trimesh.transformations import rotation_matrix, translation_matrix

from fgenv.collision import Shape, World


def place(x: float, y: float, yaw: float = 0.0) -> NDArray[np.float64]:
    """A pose on the floor: meters and radians."""
    return np.asarray(translation_matrix([x, y, 0.5]) @ rotation_matrix(yaw, [0, 0, 1]))


box = trimesh.creation.box
crate, cart, panel = (  # shapes, which any number of bodies can share
    Shape(mesh.vertices, mesh.faces)
    for mesh in (box((1.0, 1.0, 1.0)), box((1.0, 0.6, 0.3)), box((0.05, 1.9, 1.0)))
)
world = World()
for x in range(20):
    for y in range(20):
        world.add(crate, place(2.0 * x, 2.0 * y), name=f"crate {x}, {y}")
first = world.add(cart, place(1.0, -2.0), name="first")
second = world.add(cart, place(37.0, -2.0), name="second")

# Each robot's path marks the few crates near it with the robot's own bit.
lane = [place(1.0, -2.0, np.pi / 2), place(1.0, 15.0, np.pi / 2), place(1.0, 15.0, 0.0)]
near = world.set_path(first, lane)
far = world.set_path(second, [place(37.0, -2.0), place(37.0, 9.0, np.pi / 2)])
print(f"{len(near)} of {len(world) - 1} bodies are near the first path, {len(far)} near the second")
assert not set(near) & set(far)
assert {world.mask(body) for body in near} == {1}
assert {world.mask(body) for body in far} == {2}

# Every leg is proved free, or its first contact is bracketed to a micrometer.
for start, end in pairwise(lane):
    assert world.check_motion(first, start, end)
across = world.check_motion(first, lane[-1], place(20.0, 15.0))
print(f"straight on the path is free up to {19.0 * across.free_until:.6f} m: an empty aisle")
across = world.check_motion(first, lane[-1], place(20.0, 14.0))
free = np.hypot(19.0, 1.0) * across.free_until
print(f"a slanted path is free up to {free:.6f} m, to {across.other_name}")

# A door that opens by a known trajectory: shut at 0 s, open at 4 s.
door = world.add(panel, place(5.0, 15.0), name="door")
world.set_trajectory(door, [0.0, 4.0], [place(5.0, 15.0), place(5.0, 16.9)])
for begin in (0.0, 4.0):
    late, goal = begin + 4.0, place(9.0, 15.0)
    drive = world.check_motion(first, lane[-1], goal, start_time=begin, end_time=late)
    print(f"start at {begin} s: {'free' if drive else drive.other_name}")

world.clear_path(first)
world.clear_path(second)
assert not any(world.mask(int(body)) for body in world.ids)
