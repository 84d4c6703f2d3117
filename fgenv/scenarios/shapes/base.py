"""Base classes of the shapes in a scenario file, and fields with units."""

from __future__ import annotations

from abc import abstractmethod
from functools import lru_cache
from pathlib import Path
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field

from fgenv.collision import Shape

LONGEST = 1e4  # meters; a larger size is taken for an error


class Spec(BaseModel):
    """A part of a scenario file: plain values, unknown keys are errors."""

    model_config = ConfigDict(extra="forbid", frozen=True, use_attribute_docstrings=True)


def quantity(unit: str, about: str, default: Any = ..., **bounds: Any) -> Any:
    """A finite number; its unit is part of the schema."""
    extra: Any = {"unit": unit}
    about = f"{about} ({unit})"
    bounds.setdefault("allow_inf_nan", False)
    return Field(default, description=about, json_schema_extra=extra, strict=True, **bounds)


def meters(about: str, default: Any = ...) -> Any:
    """A length over 0, in meters."""
    return quantity("m", about, default, gt=0, le=LONGEST)


Length = Annotated[float, meters("Length")]


class Form(Spec):
    """A shape in a scenario file."""

    @abstractmethod
    def shape(self, folder: Path | None = None) -> Shape:
        """The shape; equal forms share one.

        Args:
            folder: folder of relative mesh paths.

        Raises:
            ValueError, FileNotFoundError: invalid sizes or mesh file.
        """


class Solid(Form):
    """A shape that is generated from its sizes."""

    @abstractmethod
    def mesh(self) -> Any:
        """The mesh, meters."""

    def shape(self, folder: Path | None = None) -> Shape:
        return _shape(self)


@lru_cache(maxsize=256)
def _shape(form: Solid) -> Shape:
    made = form.mesh()
    if isinstance(made, Shape):
        return made
    return Shape(made.vertices, made.faces, name=str(form.kind))  # type: ignore[attr-defined]
