"""Fuzz target: the bytes of a file for each reader of files.

    PYTHONPATH=tests python -m fuzz.loader -max_total_time=3600 CORPUS   # an hour; keeps new inputs
    PYTHONPATH=tests python -m fuzz.loader crash-1234                    # runs one input again

The first byte chooses the reader, the rest is the file. It is read, or raises a clear error.
"""

from __future__ import annotations

import atexit
import shutil
import tempfile
from pathlib import Path

import numpy as np

from fuzz.driver import instrument, run

if __name__ == "__main__":
    instrument("support.small_files", "fgenv.collision.mesh_files")

from support.mesh_files import mesh_cases
from support.small_files import SmallFile, small_files

from fgenv.collision import Shape

FILES = sorted(small_files(), key=lambda file: file.name)
FOLDER = Path(tempfile.mkdtemp(prefix="fgenv-fuzz-"))
PATHS: dict[str, Path] = {}
atexit.register(shutil.rmtree, FOLDER, ignore_errors=True)


def path_of(file: SmallFile) -> Path:
    """The path of a file, in a folder of its own with the files beside it."""
    if file.name not in PATHS:
        folder = FOLDER / str(len(PATHS))
        folder.mkdir()
        PATHS[file.name] = file.path(folder)
    return PATHS[file.name]


def load(data: bytes) -> None:
    """The file is read or refused; a shape is sound."""
    if not data:
        return
    file = FILES[data[0] % len(FILES)]
    path = path_of(file)
    path.write_bytes(data[1:])
    shape = file.outcome(path)
    if isinstance(shape, Shape):
        assert len(shape.faces) > 0
        assert np.isfinite(shape.vertices).all()
        assert shape.faces.min() >= 0
        assert shape.faces.max() < len(shape.vertices)


def seeds() -> list[bytes]:
    """The valid file of each reader, and all files of mesh formats."""
    made = [bytes([i]) + file.content for i, file in enumerate(FILES)]
    for case in mesh_cases():
        suffix = Path(case.name).suffix.lower()
        alike = (i for i, f in enumerate(FILES) if f.name.endswith(suffix) and f.read == Shape.load)
        made.append(bytes([next(alike)]) + case.content)
    return made


if __name__ == "__main__":
    run(load, seeds())
