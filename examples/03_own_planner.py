"""Your own OMPL script with `collide` as its state validity checker: a ring comes off a post."""

import numpy as np
import trimesh
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou

from fgenv.collision import Shape, collide

ring, post = trimesh.creation.torus(0.5, 0.1), trimesh.creation.cylinder(0.2, 1.0)
robot, obstacle = Shape(ring.vertices, ring.faces), Shape(post.vertices, post.faces)


def valid(state: ob.SE3State) -> bool:
    """OMPL needs a real bool, which `collide` returns for two single poses."""
    q = state.rotation()
    pose = trimesh.transformations.quaternion_matrix([q.w, q.x, q.y, q.z])
    pose[:3, 3] = state.getX(), state.getY(), state.getZ()
    return not collide(robot, pose, obstacle, np.eye(4))


def plan() -> list[tuple[float, ...]]:
    """Way points: x, y, z in meters, and the quaternion w, x, y, z."""
    ou.setLogLevel(ou.LOG_NONE)
    ou.RNG.setSeed(1)  # before anything is built
    bounds = ob.RealVectorBounds(3)
    bounds.setLow(-1.2)
    bounds.setHigh(1.2)
    space = ob.SE3StateSpace()
    space.setBounds(bounds)
    setup = og.SimpleSetup(space)
    setup.setStateValidityChecker(valid)
    ends = [setup.getSpaceInformation().allocState() for _ in range(2)]
    for state, x in zip(ends, (0.0, 1.1), strict=True):  # around the post, and beside it
        state.setXYZ(x, 0.0, 0.0)
        state.rotation().setIdentity()
    setup.setStartAndGoalStates(*ends)
    setup.setPlanner(og.RRTConnect(setup.getSpaceInformation()))
    setup.solve(30.0)
    assert setup.haveExactSolutionPath()
    path = setup.getSolutionPath()
    found: list[tuple[float, ...]] = []
    for s in (path.getState(i) for i in range(path.getStateCount())):
        q = s.rotation()
        found.append((s.getX(), s.getY(), s.getZ(), q.w, q.x, q.y, q.z))
    return found


way = plan()
for x, y, z, *_ in way:
    print(f"ring at ({x:.2f}, {y:.2f}, {z:.2f}) m")
