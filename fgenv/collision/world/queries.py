"""Queries at poses and at the current state: collision, clearance, contact pairs, rays."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal, overload

import numpy as np
from numpy.typing import ArrayLike

from fgenv.arrays import Ints32

from .base import Body
from .bodies import BodyMethods
from .results import Clearances, RayHits


class QueryMethods(BodyMethods):
    """Methods of `World` that query it without motion."""

    def collides(
        self,
        robot: Body,
        poses: ArrayLike,
        *,
        times: ArrayLike | None = None,
        margin: float = 0.0,
        threads: int | None = None,
    ) -> Any:
        """Whether the robot collides at poses (..., 4, 4) or configurations (..., nq).

        Touching and containment count as collision. Sound with any path set. Returns a bool or an
        array.

        Args:
            times: seconds, broadcast with the poses; other bodies follow their trajectories.
            margin: meters; bodies nearer than this collide.
        """
        return self._core.collides(robot, poses, times, margin=margin, threads=threads)

    def clearance(
        self,
        robot: Body,
        poses: ArrayLike,
        *,
        times: ArrayLike | None = None,
        threads: int | None = None,
    ) -> Clearances:
        """Distance to the nearest other body at poses (..., 4, 4) or configurations (..., nq).

        Distances between parts of the robot itself do not count.
        """
        found = self._core.clearance(robot, poses, times, threads=threads)
        return Clearances.of(found, self)

    @overload
    def contact_pairs(
        self, *, margin: float = ..., threads: int | None = ..., return_names: Literal[False] = ...
    ) -> Ints32: ...
    @overload
    def contact_pairs(
        self, *, margin: float = ..., threads: int | None = ..., return_names: Literal[True]
    ) -> list[tuple[str, str]]: ...
    def contact_pairs(
        self, *, margin: float = 0.0, threads: int | None = None, return_names: bool = False
    ) -> Ints32 | list[tuple[str, str]]:
        """All pairs of bodies that collide at their current poses.

        Returns ids (n, 2), each pair ascending and the pairs sorted; with `return_names` a list of
        pairs of names in the same order.
        """
        pairs = self._core.contact_pairs(margin, threads)
        return [(a, b) for a, b in self.body_names(pairs)] if return_names else pairs

    def raycast(
        self,
        origins: ArrayLike,
        directions: ArrayLike,
        max_distance: float = np.inf,
        *,
        ignore: Body | Sequence[Body] | None = None,
        threads: int | None = None,
    ) -> RayHits:
        """First hits of rays, (..., 3) each, on all bodies except those in `ignore`.

        Grazing rays, and rays that start on a face, follow the rules of `Shape.raycast`, as do
        lidars: exactly for the ray as placed in the frame of each body.
        """
        found = self._core.raycast(
            origins, directions, max_distance, ignore=ignore, threads=threads
        )
        return RayHits.of(found, self)
