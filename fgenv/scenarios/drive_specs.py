"""Drives and sensors in scenario files: one model per registered drive, made from its fields."""

from __future__ import annotations

import math
from dataclasses import MISSING, fields, is_dataclass
from functools import reduce
from operator import or_
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, get_type_hints

from pydantic import Field, create_model

from fgenv.robots import Drive
from fgenv.robots.drives import DRIVES
from fgenv.robots.drives.base import DrivePart
from fgenv.scenarios.shapes.base import Spec, meters, quantity

MAX_LIMIT = 1e6  # m/s, rad/s, m/s^2, rad/s^2


class DriveSpec(Spec):
    """Base class of drives in scenario files."""

    drive_class: ClassVar[type[Drive]]
    kind: str

    @staticmethod
    def of(drive: Drive) -> DriveSpec:
        """The spec of a drive; its defaults are left out."""
        given: dict[str, Any] = {"kind": drive.kind}
        for item in fields(drive):  # type: ignore[arg-type]
            value = getattr(drive, item.name)
            if value != item.default:
                given[item.name] = DriveSpec.of(value) if is_dataclass(value) else value  # type: ignore[arg-type]
        return SPECS[type(drive)](**given)

    def build(self) -> Drive:
        """The drive of `fgenv.robots`."""
        given = {name: value for name, value in self if name != "kind" and value is not None}
        parts = {k: v.build() if isinstance(v, DriveSpec) else v for k, v in given.items()}
        return self.drive_class(**parts)


def _field(item: Any, hint: Any) -> tuple[Any, Any]:
    """Type and default of a drive's field in the spec."""
    if not hasattr(hint, "__metadata__"):  # a drive in a drive
        specs = [spec for drive, spec in SPECS.items() if issubclass(drive, hint)]
        default = ... if item.default is MISSING else DriveSpec.of(item.default)
        return (_union(specs) if len(specs) > 1 else specs[0]), default
    about = hint.__metadata__[0]
    if item.default is not MISSING:  # None: no limit, or the default that the text describes
        default = quantity(about.unit, about.about, None, gt=0, le=MAX_LIMIT)
        return float | None, default
    if about.unit == "m":
        return float, meters(about.about)
    return float, quantity(about.unit, about.about, gt=0, le=MAX_LIMIT)


def _spec(drive: type[Drive]) -> type[DriveSpec]:
    hints = get_type_hints(drive, include_extras=True)
    about: dict[str, Any] = {}
    for item in fields(drive):  # type: ignore[arg-type]
        about[item.name] = _field(item, hints[item.name])
    kind: Any = Literal[drive.kind]
    doc = (drive.__doc__ or "").partition("\n")[0]
    made = create_model(drive.__name__, __base__=DriveSpec, __doc__=doc, kind=(kind, ...), **about)
    made.drive_class = drive
    return made


def _union(specs: list[type[DriveSpec]]) -> Any:
    return Annotated[reduce(or_, specs), Field(discriminator="kind")]


SPECS: dict[type[Drive], type[DriveSpec]] = {}
for _drive in sorted(  # drives that contain others last
    DRIVES.values(), key=lambda drive: not issubclass(drive, DrivePart)
):
    SPECS[_drive] = _spec(_drive)
    globals()[_drive.__name__] = SPECS[_drive]  # for pickle

if TYPE_CHECKING:
    AnyDrive = DriveSpec
else:
    AnyDrive = _union(list(SPECS.values()))


class Lidar(Spec):
    """Rays from a point of the robot's root, spread evenly; hits are on the exact meshes."""

    rays: int = Field(default=12, ge=1, le=100_000, strict=True, description="Rays in a row")
    range: float = meters("How far a ray reaches", 5.0)
    field_of_view: float = quantity(
        "rad",
        "Horizontal field of view, about x; 2 pi is a full circle",
        2 * math.pi,
        gt=0,
        le=6.283185307179587,
    )
    rows: int = Field(default=1, ge=1, le=1000, strict=True, description="Rows: more than 1 is 3D")
    rise: float = quantity(
        "rad", "Vertical field of view, from the lowest to the highest row", 0.0, ge=0, le=3.15
    )
    position: tuple[float, float, float] = Field(
        default=(0.0, 0.0, 0.1), description="On the root (m)"
    )
