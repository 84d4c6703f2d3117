"""Locations of mesh files that a URDF file refers to."""

from __future__ import annotations

import os
from collections.abc import Iterable, Sequence
from pathlib import Path


def find_mesh(name: str, urdf: Path, package_dirs: Sequence[Path]) -> Path:
    """The file of a mesh's URI or path.

    Raises:
        FileNotFoundError: no such file, with the places searched.
    """
    tried = list(dict.fromkeys(candidates(name, urdf, package_dirs)))
    for place in tried:
        if place.is_file():
            return place
    searched = ", ".join(map(str, tried))
    package = name.removeprefix("package://").split("/")[0]
    remedy = (
        f"give package_dirs=[the folder that holds {package!r}]"
        if name.startswith("package://")
        else "put it there"
    )
    raise FileNotFoundError(f"mesh {name!r}: got no such file in {searched}; {remedy}")


def candidates(name: str, urdf: Path, package_dirs: Iterable[Path]) -> Iterable[Path]:
    """Possible locations of the file of a URI or path, the likeliest first.

    `package://NAME/REST` is searched in `package_dirs` (folders of packages, or a package
    itself), in ROS_PACKAGE_PATH, and in the folders above the URDF file.
    """
    above = urdf.resolve().parents
    if not name.startswith("package://"):
        plain = Path(name.removeprefix("file://"))
        yield plain if plain.is_absolute() else above[0] / plain
        return
    package, _, rest = name.removeprefix("package://").partition("/")
    ros = (Path(p) for p in os.environ.get("ROS_PACKAGE_PATH", "").split(os.pathsep) if p)
    for folder in (*package_dirs, *ros, *above):
        if folder.name == package:
            yield folder / rest
        yield folder / package / rest
