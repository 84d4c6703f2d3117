"""Checks of motions, and moving robots up to their first contact."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .base import TOLERANCE, Body
from .bodies import BodyMethods
from .results import MotionResult

Robots = Sequence[Body] | NDArray[np.integer[Any]]


class MotionMethods(BodyMethods):
    """Methods of `World` that check or execute motions."""

    def check_motion(
        self,
        robot: Body,
        start: ArrayLike,
        end: ArrayLike,
        *,
        margin: float = 0.0,
        tolerance: float = TOLERANCE,
        mode: str = "continuous",
        resolution: float | None = None,
        first_contact: bool = True,
        start_time: float | None = None,
        end_time: float | None = None,
        threads: int | None = None,
    ) -> MotionResult:
        """Check the motion from `start` to `end`, (..., 4, 4) or (..., nq), for contact.

        The position is linear; the orientation follows the shortest arc from the start's, about the
        robot's origin. A kinematic robot moves as `Robot.interpolate` does, all links at once, and
        is also tested against itself. No body is tunneled through, however thin or fast.

        Args:
            margin: meters; bodies nearer than this are in contact.
            tolerance: meters; no point of the robot moves farther between `free_until` and
                `contact_by`, unless bodies graze or coordinates are rounded more coarsely.
            mode: `continuous`, or `discrete`: tested at steps, as OMPL does, which can tunnel.
            resolution: meters; no point moves farther in a step of `discrete`.
            first_contact: False: report any contact, which takes less time.
            start_time, end_time: seconds; other bodies follow their trajectories. Default: other
                bodies rest at their current poses.
        """
        found = self._core.check_motion(
            robot,
            start,
            end,
            margin=margin,
            tolerance=tolerance,
            mode=mode,
            resolution=resolution,
            first_contact=first_contact,
            start_time=start_time,
            end_time=end_time,
            threads=threads,
        )
        return MotionResult.of(found, self)

    def check_motions(
        self,
        robots: Robots,
        start: ArrayLike,
        end: ArrayLike,
        *,
        margin: float = 0.0,
        tolerance: float = TOLERANCE,
        start_time: float | None = None,
        end_time: float | None = None,
    ) -> MotionResult:
        """Check simultaneous motions of robots (n,), also against each other.

        Each robot's result is its first contact, as if no robot stopped at a contact.

        Args:
            start, end: (n, 4, 4), or (n, nq) for robots that all have the same coordinates.
            margin, tolerance, start_time, end_time: as for `check_motion`.
        """
        found = self._core.check_motions(
            robots,
            start,
            end,
            margin=margin,
            tolerance=tolerance,
            start_time=start_time,
            end_time=end_time,
        )
        return MotionResult.of(found, self)

    def motions_collide(
        self,
        a: Body,
        start_a: ArrayLike,
        end_a: ArrayLike,
        b: Body,
        start_b: ArrayLike,
        end_b: ArrayLike,
        *,
        margin: float = 0.0,
        tolerance: float = TOLERANCE,
        threads: int | None = None,
    ) -> Any:
        """Whether simultaneous motions of two robots are not proved free: bool or array.

        Only these two robots are tested, whatever the current poses in the world.

        Args:
            start_a, end_a, start_b, end_b: poses (..., 4, 4) or configurations (..., nq); they
                broadcast.
            margin, tolerance: as for `check_motion`.
        """
        return self._core.motions_collide(
            a,
            start_a,
            end_a,
            b=b,
            start_b=start_b,
            end_b=end_b,
            margin=margin,
            tolerance=tolerance,
            threads=threads,
        )

    def advance(
        self,
        robots: Robots,
        end: ArrayLike,
        *,
        margin: float = 0.0,
        tolerance: float = TOLERANCE,
        start_time: float | None = None,
        end_time: float | None = None,
    ) -> MotionResult:
        """Move robots (n,) simultaneously from their current poses, each up to its first contact.

        Both robots of a contact stop there, in chronological order; later arrivals collide with the
        stopped robots. `free_until` is the fraction of its motion that a robot has completed.
        Robots that did not overlap before do not overlap afterwards.

        Args:
            end: (n, 4, 4), or (n, nq) for robots that all have the same coordinates.
            margin, tolerance, start_time, end_time: as for `check_motion`.
        """
        found = self._core.advance(
            robots,
            end,
            margin=margin,
            tolerance=tolerance,
            start_time=start_time,
            end_time=end_time,
        )
        return MotionResult.of(found, self)
