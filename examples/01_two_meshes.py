"""Two meshes: collision, distance, and the point of contact."""

import numpy as np
import trimesh

from fgenv.collision import Shape, collide, contact_point, nearest_points

# Shapes are arrays of vertices (meters) and triangles; Shape.load("link.stl") reads files.
ring = trimesh.creation.torus(major_radius=0.3, minor_radius=0.05)
peg = trimesh.creation.cylinder(radius=0.2, height=0.4)
a = Shape(ring.vertices, ring.faces, name="ring")
b = Shape(peg.vertices, peg.faces, name="peg")

# Poses are 4x4 matrices and broadcast: here the peg slides sideways in the ring's hole.
here, slide = np.eye(4), np.tile(np.eye(4), (9, 1, 1))
slide[:, 0, 3] = np.linspace(0.0, 0.08, 9)

hits = collide(a, here, b, slide)
gaps = nearest_points(a, here, b, slide)
for pose, hit, gap in zip(slide, hits, gaps.distance, strict=True):
    print(f"peg at x = {pose[0, 3]:.2f} m: {'collides' if hit else f'free, {gap * 1e3:.1f} mm'}")

touch = contact_point(a, here, b, slide[hits.argmax()])
assert touch is not None
print(f"first contact at {touch.point.round(3)}, to push the ring along {touch.normal.round(2)}:")
print(f"a feature edge of {touch.edge_of} meets face {touch.face} of the other")
