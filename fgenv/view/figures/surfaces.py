"""Elements of a scene that is painted: solids, a floor, a light."""

from dataclasses import dataclass

import numpy as np

from fgenv.arrays import Floats
from fgenv.collision import Shape
from fgenv.view.figures.palette import Color


@dataclass(frozen=True)
class Solid:
    """A shape at a pose (4, 4) in an sRGB color.

    A solid with an opacity below 1 is translucent, receives no shadow and casts none.
    """

    shape: Shape
    pose: Floats
    color: Color
    opacity: float = 1.0


@dataclass(frozen=True)
class Floor:
    """The ground plane z = `height` (m) with grid lines every `grid` meters.

    The floor fades into the sky over `fade` meters. By default that distance is `FADE`, and more
    where the camera is far from its target.
    """

    height: float = 0.0
    color: Color = (0.91, 0.91, 0.90)
    grid: float = 1.0
    fade: float | None = None


@dataclass(frozen=True)
class Light:
    """A sun in the direction `to` (from the scene) with its strength, and the light of the sky."""

    to: tuple[float, float, float] = (-0.35, -0.55, 0.75)
    sun: float = 0.66
    above: Color = (0.40, 0.43, 0.47)  # linear light of the sky
    below: Color = (0.24, 0.22, 0.20)  # linear light from the ground
    zenith: Color = (0.74, 0.82, 0.90)  # sRGB color of the sky overhead
    horizon: Color = (0.96, 0.97, 0.98)

    @property
    def direction(self) -> Floats:
        """The unit vector to the sun."""
        to = np.array(self.to, dtype=np.float64)
        return to / np.linalg.norm(to)
