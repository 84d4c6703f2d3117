"""Meshes of furniture: boxes that overlap. Meters; each stands on the floor at its origin."""

from __future__ import annotations

import trimesh

from .three_tanks import block, joined


def legs(x: float, y: float, leg: float, height: float) -> list[trimesh.Trimesh]:
    """Four square legs, their outer corners at x, y."""
    return [
        block((min(sx * x, sx * (x - leg)), min(sy * y, sy * (y - leg)), 0.0),
              (max(sx * x, sx * (x - leg)), max(sy * y, sy * (y - leg)), height))
        for sx in (-1, 1) for sy in (-1, 1)
    ]  # fmt: skip


def table(length: float, width: float, height: float, leg: float) -> trimesh.Trimesh:
    """A table: a top as thick as a leg; the legs end in the middle of the top."""
    x, y = length / 2, width / 2
    top = block((-x, -y, height - leg), (x, y, height))
    return joined([top, *legs(0.97 * x, 0.97 * y, leg, height - leg / 2)])


def chair(width: float, seat: float, height: float) -> trimesh.Trimesh:
    """A chair: a seat, four legs, and a back at -x."""
    x, thick = width / 2, 0.04
    board = block((-x, -x, seat - thick), (x, x, seat))
    back = block((-x, -x, seat - thick / 2), (-x + thick, x, height))
    return joined([board, back, *legs(0.97 * x, 0.97 * x, thick, seat - thick / 2)])
