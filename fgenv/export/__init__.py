"""Meshes, robots and scenarios written to files, in meters.

>>> from fgenv.export import mesh_parts, robot_parts, scenario_parts, write_meshes, write_urdf
>>> write_meshes(mesh_parts(shape), "part.stl")
>>> write_meshes(robot_parts(robot, q), "arm.glb")           # at a configuration
>>> write_meshes(scenario_parts(scenario), "scene.obj")      # robots at their starts
>>> write_urdf(robot, "arm.urdf")                            # with its meshes and arm.srdf

OBJ and URDF keep every bit of a coordinate; STL and GLB store single precision. Axes are those of
fgenv, z up, in all formats: GLB viewers that expect y up show a scene lying on its side.
"""

from fgenv.export.meshes import FORMATS, PlacedMesh, write_meshes
from fgenv.export.parts import mesh_parts, robot_parts, scenario_parts
from fgenv.export.urdf import write_urdf

__all__ = [
    "FORMATS",
    "PlacedMesh",
    "mesh_parts",
    "robot_parts",
    "scenario_parts",
    "write_meshes",
    "write_urdf",
]


def __dir__() -> list[str]:
    return __all__
