"""Lengths of mesh files: a size that is implausible in meters has another unit."""

from __future__ import annotations

import numpy as np

from .content import FileMesh

LARGEST, SMALLEST = 100.0, 1e-4  # meters: extents of plausible parts and scenes


def unit_warning(mesh: FileMesh, scale: float) -> str | None:
    """The warning on a mesh of implausible size in meters; None if the size is plausible.

    A file that states its unit, and a scale other than 1, are taken as given.
    """
    if mesh.unit is not None or scale != 1.0 or not len(mesh.vertices):
        return None
    largest = max(float(np.ptp(mesh.vertices[:, k])) for k in range(3))  # fast by columns
    if largest > LARGEST:
        remedy = "scale=0.001 if its lengths are millimeters"
    elif largest < SMALLEST:
        remedy = "scale=1000 if its lengths are kilometers"
    else:
        return None
    return f"is {largest:g} m across, and {mesh.format} has no unit; use {remedy}"
