"""Fuzz target: the bytes of a mesh file of each format, through `Shape.load`.

    PYTHONPATH=tests python -m fuzz.loader -max_total_time=3600 CORPUS   # an hour; keeps new inputs
    PYTHONPATH=tests python -m fuzz.loader crash-1234                    # runs one input again

The first byte chooses the format, the rest is the file. It is read, or raises a one-line error.
"""

from __future__ import annotations

import atexit
import logging
import shutil
import tempfile
import warnings
from pathlib import Path
from typing import Any

from fuzz.driver import instrument, one_line, run

if __name__ == "__main__":
    instrument("trimesh", "collada", "fgenv.collision", "fgenv.collision.mesh_files")

import numpy as np
import trimesh
from oracles.solids import angle_iron, box
from support.mesh_files import mesh_cases

from fgenv.collision import Shape
from fgenv.collision.mesh_files import READERS

FORMATS = [suffix[1:] for suffix in READERS] + ["stl.gz", "obj.gz", "zip"]
FOLDER = Path(tempfile.mkdtemp(prefix="fgenv-fuzz-"))
atexit.register(shutil.rmtree, FOLDER, ignore_errors=True)


def load(data: bytes) -> None:
    """The file becomes a sound shape or one line of an error."""
    if not data:
        return
    path = FOLDER / f"mesh.{FORMATS[data[0] % len(FORMATS)]}"
    path.write_bytes(data[1:])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            shape = Shape.load(path)
        except (ValueError, TypeError, FileNotFoundError) as error:
            one_line(error, path.name)
            return
    assert len(shape.faces) > 0
    assert np.isfinite(shape.vertices).all()
    assert shape.faces.min() >= 0
    assert shape.faces.max() < len(shape.vertices)


def seeds() -> list[bytes]:
    """Small complete files of each format: those of the tests, and those that trimesh writes."""
    made = []
    for case in mesh_cases():
        ending = next(e for e in reversed(FORMATS) if case.name.lower().endswith(e.lower()))
        made.append(bytes([FORMATS.index(ending)]) + case.content)
    for extension in ("glb", "dae", "3mf"):
        content: Any = trimesh.Trimesh(*angle_iron(), process=False).export(file_type=extension)
        made.append(bytes([FORMATS.index(extension)]) + bytes(content))
    scene: Any = trimesh.Scene([trimesh.Trimesh(*box(1.0)), trimesh.Trimesh(*angle_iron())])
    made.append(bytes([FORMATS.index("glb")]) + bytes(scene.export(file_type="glb")))
    return made


if __name__ == "__main__":
    logging.disable(logging.CRITICAL)  # trimesh logs every invalid file
    run(load, seeds())
