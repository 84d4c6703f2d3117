"""Formats of robot files: the reader for each, by the name's ending or the root element."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from fgenv.file_kind import ROBOT, other_kind
from fgenv.printable import printable

from .configuration_space import ConfigurationSpace
from .documents import read_document
from .mesh_location import PackagePaths
from .mimic_limits import without_contradictions
from .mjcf import read_mjcf
from .robot_file import RobotFile
from .sdf import read_sdf
from .urdf import read_urdf

SUFFIXES = {".urdf": "robot", ".xacro": "robot", ".sdf": "sdf"}  # others: the root element says
USD = (".usd", ".usda", ".usdc", ".usdz")


@dataclass(frozen=True)
class ReadOptions:
    """Options of reading a robot file; see `Robot.load`."""

    packages: PackagePaths = field(default_factory=PackagePaths)
    collision: bool = True
    scale: float = 1.0
    error: float = 0.0
    shape_options: Mapping[str, Any] = field(default_factory=dict)
    soft_limits: bool = False
    xacro_args: Mapping[str, str] = field(default_factory=dict)
    root: str | None = None


def read_robot(path: Path, options: ReadOptions) -> RobotFile:
    """Read a robot file of any format.

    Raises:
        FileNotFoundError, ModuleNotFoundError: no such file; a package is not installed.
        ValueError: another format, invalid content, or an option that the format does not have.
    """
    root = root_element(path)
    used = {"robot": ("packages", "soft_limits", "xacro_args"), "sdf": ("packages",)}
    for name in ("packages", "soft_limits", "xacro_args", "root"):
        default = getattr(ReadOptions(), name)
        if name not in used.get(root, ("root",)) and getattr(options, name) != default:
            label = "package_dirs" if name == "packages" else name
            raise ValueError(f"{label}: got a value for {path}, which has no use for it; remove it")
    file = READERS[root](path, options)
    joints = without_contradictions(file.joints, file.notes)
    try:
        ConfigurationSpace(file.name, tuple(file.links), tuple(joints))
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    return replace(file, joints=joints)


def root_element(path: Path) -> str:
    """Name of the root element: `robot` (URDF), `mujoco` (MJCF) or `sdf`.

    Raises:
        FileNotFoundError, ValueError: no such file, or another format.
    """
    suffix = path.suffix.lower()
    if suffix in USD:
        raise ValueError(f"path: {path} is USD, which is not read; export it as URDF or MJCF")
    if other := other_kind(path, ROBOT):
        raise ValueError(printable(f"path: {path}: {other}"))
    if suffix in SUFFIXES:
        return SUFFIXES[suffix]
    expected = "a robot as URDF, xacro, MJCF or SDF"
    name = read_document(path, expected).tag
    if name not in READERS:
        raise ValueError(f"path: {path}: got <{name}>, expected {expected}")
    return name


def _read_urdf(path: Path, options: ReadOptions) -> RobotFile:
    return read_urdf(
        path,
        options.packages,
        soft_limits=options.soft_limits,
        xacro_args=options.xacro_args,
        **_common(options),
    )


def _read_sdf(path: Path, options: ReadOptions) -> RobotFile:
    return read_sdf(path, options.packages, **_common(options))


def _read_mjcf(path: Path, options: ReadOptions) -> RobotFile:
    return read_mjcf(path, root=options.root, **_common(options))


def _common(options: ReadOptions) -> dict[str, Any]:
    return {
        "collision": options.collision,
        "scale": options.scale,
        "error": options.error,
        "shape_options": dict(options.shape_options),
    }


READERS: dict[str, Callable[[Path, ReadOptions], RobotFile]] = {
    "robot": _read_urdf,
    "sdf": _read_sdf,
    "mujoco": _read_mjcf,
}
