"""Scenes: a world of bodies, and a mover with a start and a goal."""

from fgenv.scenarios.scene import Scene, bounds, in_contact
from fgenv.scenarios.three_tanks import three_tanks

__all__ = ["Scene", "bounds", "in_contact", "three_tanks"]
