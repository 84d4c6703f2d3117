"""Drives, one per module; each module of this package registers its drive in `DRIVES`."""

from importlib import import_module
from pkgutil import iter_modules

from .base import DRIVES, Action, Drive
from .car import Car
from .differential import DifferentialDrive
from .drone import Drone
from .holonomic import Holonomic
from .joint_velocity import JointVelocity
from .mobile_manipulator import MobileManipulator
from .platform import Platform
from .steering import Steering

for _module in iter_modules(__path__):
    import_module(f"{__name__}.{_module.name}")

__all__ = [
    "DRIVES",
    "Action",
    "Car",
    "DifferentialDrive",
    "Drive",
    "Drone",
    "Holonomic",
    "JointVelocity",
    "MobileManipulator",
    "Platform",
    "Steering",
]
