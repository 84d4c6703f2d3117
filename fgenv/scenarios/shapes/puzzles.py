"""Shapes of the puzzles and of the home, as a scenario file writes them."""

from __future__ import annotations

import math
from typing import Any, Literal

from fgenv.scenarios.meshes import furniture, puzzles

from .base import LONGEST, Solid, meters, quantity


def turn(about: str) -> Any:
    """Up to half a turn, either way."""
    return quantity("rad", about, ge=-math.pi, le=math.pi)


class Cone(Solid):
    """A cone about z, its tip up, half its height at the origin; the mesh encloses it by 1 mm."""

    kind: Literal["cone"]
    radius: float = meters("Radius at the bottom")
    height: float = meters("Height")

    def mesh(self) -> Any:
        return puzzles.cone(self.radius, self.height)


class Table(Solid):
    """A table on four legs; stands on the floor at its origin."""

    kind: Literal["table"]
    length: float = meters("Along x")
    width: float = meters("Along y")
    height: float = meters("Height")
    leg: float = meters("Thickness of a leg, and of the top", 0.06)

    def mesh(self) -> Any:
        return furniture.table(self.length, self.width, self.height, self.leg)


class Chair(Solid):
    """A chair on four legs, its back at -x; stands on the floor at its origin."""

    kind: Literal["chair"]
    width: float = meters("Size of the seat, along x and y", 0.45)
    seat: float = meters("Height of the seat, below the height", 0.46)
    height: float = meters("Height of the back", 0.9)

    def mesh(self) -> Any:
        if self.seat >= self.height:
            raise ValueError(f"seat: got {self.seat:g}, expected less than the height")
        return furniture.chair(self.width, self.seat, self.height)


class TwistedBar(Solid):
    """A bar along x that turns about x from its one end to the other; its middle at the origin."""

    kind: Literal["twisted_bar"]
    length: float = meters("Along x")
    width: float = meters("Width of the section, along y in the middle")
    height: float = meters("Height of the section, along z in the middle")
    turn: float = turn("From -x to +x, about x")

    def mesh(self) -> Any:
        return puzzles.twisted_bar(self.length, self.width, self.height, self.turn)


class TwistedWall(Solid):
    """A wall across x, its middle at the origin, with a channel that turns about x on its way."""

    kind: Literal["twisted_wall"]
    thickness: float = meters("Along x")
    side: float = meters("Along y and z")
    width: float = meters("Width of the channel, along y at -x")
    height: float = meters("Height of the channel, along z at -x")
    turn: float = turn("From -x to +x, about x")

    def mesh(self) -> Any:
        if self.side <= 1.5 * math.hypot(self.width, self.height):
            raise ValueError(
                f"side: got {self.side:g}, expected more than 1.5 diagonals of the channel"
            )
        sizes = self.width, self.height
        return puzzles.twisted_wall(self.thickness, self.side, *sizes, self.turn)


class BugTrap(Solid):
    """A hollow ball with a funnel that leads in from +z; its middle at the origin."""

    kind: Literal["bug_trap"]
    radius: float = meters("Of the ball")
    wall: float = meters("Thickness of the wall, at least 3 % of the radius")
    throat: float = meters("Radius of the funnel's narrow end; with the wall below radius / 2")

    def mesh(self) -> Any:
        if self.throat + self.wall >= 0.5 * self.radius:
            raise ValueError(
                f"throat: {self.throat:g}, with the wall expected less than radius / 2"
            )
        if self.wall < 0.03 * self.radius:
            raise ValueError(f"wall: got {self.wall:g}, expected at least 3 % of the radius")
        return puzzles.bug_trap(self.radius, self.wall, self.throat)


class OpenRing(Solid):
    """A round bar bent to a ring about z, its ends at +x; where they overlap, one is above."""

    kind: Literal["open_ring"]
    radius: float = meters("Of the bar's middle line")
    thickness: float = meters("Diameter of the bar, below the radius")
    turn: float = quantity("rad", "That the bar goes round", gt=0, le=9.4)
    rise: float = quantity("m", "Of the bar in a full turn", 0.0, ge=0, le=LONGEST)

    def mesh(self) -> Any:
        if self.thickness >= self.radius:
            raise ValueError(f"thickness: got {self.thickness:g}, expected less than the radius")
        if self.turn >= 6.2 and self.rise <= self.thickness:
            raise ValueError("rise: expected more than the thickness, as the ends overlap")
        return puzzles.open_ring(self.radius, self.thickness, self.turn, self.rise)
