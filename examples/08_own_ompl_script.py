"""Your own OMPL script on exact meshes: a validity checker and a motion validator, two lines."""

from itertools import pairwise

import numpy as np
import trimesh
from ompl import base as ob
from ompl import geometric as og
from ompl import util as ou
from trimesh.transformations import translation_matrix

from fgenv.collision import Shape, World
from fgenv.planners import MotionValidator, StateValidityChecker
from fgenv.robots import Robot

ou.setLogLevel(ou.LOG_WARN)
ou.RNG.setSeed(1)  # before anything is built

sofa, wall = trimesh.creation.box((1.8, 0.8, 0.7)), trimesh.creation.box((0.1, 3.0, 2.5))
world, part = World(), Shape(wall.vertices, wall.faces)
world.add_robot(Robot.from_mesh(Shape(sofa.vertices, sofa.faces), name="sofa", base="planar"))
for y in (-2.0, 2.0):  # a doorway one meter wide
    world.add(part, translation_matrix([0, y, 0]), name=f"wall {y}")

space = ob.SE2StateSpace()
bounds = ob.RealVectorBounds(2)
bounds.setLow(-3.0)
bounds.setHigh(3.0)
space.setBounds(bounds)
setup = og.SimpleSetup(space)
si = setup.getSpaceInformation()
setup.setStateValidityChecker(StateValidityChecker(si, "sofa", world))
si.setMotionValidator(MotionValidator(si, "sofa", world))  # proves the whole edge, no steps

start, goal = si.allocState(), si.allocState()
for state, (x, y, yaw) in ((start, (-2.0, 1.0, 1.57)), (goal, (2.0, -1.0, 1.57))):
    state.setX(x)
    state.setY(y)
    state.setYaw(yaw)
setup.setStartAndGoalStates(start, goal)
setup.setPlanner(og.RRTConnect(si))
assert setup.solve(10.0)
assert setup.haveExactSolutionPath()
setup.simplifySolution()

path = setup.getSolutionPath()
states = [path.getState(k) for k in range(path.getStateCount())]
way = np.array([(s.getX(), s.getY(), s.getYaw()) for s in states])
print(f"{len(way)} waypoints, {path.length():.2f} m through the door:")
print(way.round(2))
for a, b in pairwise(way):
    assert world.check_motion("sofa", a, b)  # the same certified check
