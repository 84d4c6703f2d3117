"""Locations of the mesh files that a robot file refers to."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import unquote

from fgenv.printable import printable

from .documents import read_document

PACKAGE_SCHEMES = ("package://", "model://")
MAX_PACKAGES = 1000  # folders whose package.xml is read
MAX_PACKAGE_BYTES = 1 << 20


@dataclass(frozen=True)
class PackagePaths:
    """Folders in which packages are searched first.

    Attributes:
        folders: folders of packages, or packages.
        packages: folders of packages by name.
    """

    folders: tuple[Path, ...] = ()
    packages: Mapping[str, Path] = field(default_factory=dict)

    @classmethod
    def of(
        cls, given: str | Path | Iterable[str | Path] | Mapping[str, str | Path]
    ) -> PackagePaths:
        """From folders, or a mapping of names of packages to their folders."""
        if isinstance(given, Mapping):
            return cls(packages={name: Path(folder) for name, folder in given.items()})
        folders = [given] if isinstance(given, (str, Path)) else given
        return cls(tuple(Path(folder) for folder in folders))


def find_mesh(name: str, source: Path, paths: PackagePaths) -> Path:
    """The file of a mesh's URI or path.

    Raises:
        FileNotFoundError: no such file, with the places searched.
    """
    tried: dict[Path, None] = {}
    for place in candidates(name, source, paths):
        if place.is_file():
            return place
        tried[place] = None
    searched = ", ".join(printable(str(place)) for place in tried) or "no folder"
    scheme = next((s for s in PACKAGE_SCHEMES if name.startswith(s)), None)
    remedy = "put it there"
    if scheme is not None:
        package = name.removeprefix(scheme).split("/")[0]
        remedy = f"give package_dirs=[the folder that holds {package!r}] or {{{package!r}: folder}}"
    raise FileNotFoundError(f"mesh {name!r}: got no such file in {searched}; {remedy}")


def find_package(name: str, source: Path, paths: PackagePaths) -> Path:
    """The folder of a package, searched as for `package://NAME`.

    Raises:
        FileNotFoundError: no such package, with the remedy.
    """
    for place in candidates(f"package://{name}/", source, paths):
        if place.is_dir():
            return place
    raise FileNotFoundError(
        f"no package {name!r} in package_dirs, ROS_PACKAGE_PATH, AMENT_PREFIX_PATH and the folders"
        f" above {source}; give package_dirs={{{name!r}: its folder}}"
    )


def candidates(name: str, source: Path, paths: PackagePaths) -> Iterator[Path]:
    """Possible locations of the file of a URI or path, the likeliest first.

    `package://NAME/REST` and `model://NAME/REST` are searched in `paths`, in ROS_PACKAGE_PATH,
    below AMENT_PREFIX_PATH, and in the folders above the file, by the name of a folder or of its
    package.xml. %20 and the like are decoded if there is no file with the name as it stands.
    """
    yield from _candidates(name, source, paths)
    if "%" in name:
        yield from _candidates(unquote(name), source, paths)


def _candidates(name: str, source: Path, paths: PackagePaths) -> Iterator[Path]:
    above = source.resolve().parents
    scheme = next((s for s in PACKAGE_SCHEMES if name.startswith(s)), None)
    if scheme is None:
        plain = Path(name.removeprefix("file://"))
        yield plain if plain.is_absolute() else above[0] / plain
        return
    package, _, rest = name.removeprefix(scheme).partition("/")
    if package in paths.packages:
        yield paths.packages[package] / rest
        return
    folders = (*paths.folders, *_listed("ROS_PACKAGE_PATH"), *above)
    for folder in folders:
        if folder.name == package:
            yield folder / rest
        yield folder / package / rest
    for prefix in _listed("AMENT_PREFIX_PATH"):
        yield prefix / "share" / package / rest
    for folder in _named_by_xml(package, folders):
        yield folder / rest


def _listed(variable: str) -> list[Path]:
    return [Path(p) for p in os.environ.get(variable, "").split(os.pathsep) if p]


def _named_by_xml(package: str, folders: Iterable[Path]) -> Iterator[Path]:
    """Folders, or folders in them, whose package.xml has a name: unpacked archives are renamed."""
    read = 0
    for folder in folders:
        try:
            children = sorted(path for path in folder.iterdir() if path.is_dir())
        except OSError:
            continue
        for place in (folder, *children):
            file = place / "package.xml"
            if read < MAX_PACKAGES and file.is_file():
                read += 1
                if _package_name(file) == package:
                    yield place


def _package_name(file: Path) -> str | None:
    """The name in a package.xml; None for a file without one."""
    try:
        name = read_document(file, "a package.xml", MAX_PACKAGE_BYTES).first("name")
    except (OSError, ValueError):
        return None
    return None if name is None else name.text.strip()
