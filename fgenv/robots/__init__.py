"""Robots: kinematic trees with shapes on their links, and drives.

>>> from fgenv.robots import DifferentialDrive, Robot
>>> cart = Robot.from_mesh("cart.stl", drive=DifferentialDrive(speed=1.0, turn_rate=1.5))
>>> arm = Robot.load("panda.urdf")       # pip install 'fgenv[urdf]'
>>> arm.forward(arm.rest, "panda_hand")       # (4, 4)
"""

from .drives import (
    Action,
    Car,
    DifferentialDrive,
    Drive,
    Drone,
    Holonomic,
    JointVelocity,
    MobileManipulator,
    Platform,
    Steering,
)
from .kinematic_tree import LinkMotion, Part
from .links_joints import Joint, Link, LinkShape, Mimic
from .robot import Robot

__all__ = [
    "Action",
    "Car",
    "DifferentialDrive",
    "Drive",
    "Drone",
    "Holonomic",
    "Joint",
    "JointVelocity",
    "Link",
    "LinkMotion",
    "LinkShape",
    "Mimic",
    "MobileManipulator",
    "Part",
    "Platform",
    "Robot",
    "Steering",
]


def __dir__() -> list[str]:
    return __all__
