"""Scenes of bodies with shapes, and the masks that a motion sets in them."""

from fgenv.scenarios.body import Body, Scene
from fgenv.scenarios.masks import clear_masks, motion_box, must_test, set_masks
from fgenv.scenarios.three_tanks import three_tanks

__all__ = [
    "Body",
    "Scene",
    "clear_masks",
    "motion_box",
    "must_test",
    "set_masks",
    "three_tanks",
]
