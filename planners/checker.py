"""Native checker for the joint states of bodies and robots."""

from __future__ import annotations

from collections.abc import Sequence

from fgenv import _core
from fgenv.arrays import Floats
from fgenv.collision import World
from fgenv.collision.world import TOLERANCE, Body
from fgenv.robots import Steering

UNBOUNDED = [-float("inf")] * 2 + [float("inf")] * 2


def joint_checker(
    world: World,
    bodies: Sequence[Body],
    sizes: Sequence[int],
    margin: float = 0.0,
    *,
    steerings: Sequence[Steering] | None = None,
    resolution: float | None = None,
    regions: Sequence[Floats | None] | None = None,
) -> _core.Checker:
    """Return a checker for joint states; a joint state lists the bodies' states in order.

    Args:
        world: its other bodies are the obstacles.
        bodies: ids or names of robots and bodies.
        sizes: numbers in each body's state; nq for a robot's configuration.
        margin: meters.
        steerings: of each body; straight motions by default.
        resolution: meters; see `MotionValidator`. Motions are certified by default.
        regions: lowest and highest position of each base, (2, 2) or (2, 3), meters; None:
            unbounded.
    """
    steerings = [Steering()] * len(bodies) if steerings is None else steerings
    regions = [None] * len(bodies) if regions is None else regions
    return _core.Checker(
        world._core,
        list(bodies),
        list(sizes),
        ways=[s.code for s in steerings],
        radii=[s.radius for s in steerings],
        reverse=[s.reverse for s in steerings],
        margin=margin,
        tolerance=TOLERANCE,
        resolution=resolution or 0.0,
        regions=[UNBOUNDED if r is None else r[:, :2].ravel().tolist() for r in regions],
    )
