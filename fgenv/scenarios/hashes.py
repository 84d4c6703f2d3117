"""Hashes of the files of a scenario."""

from __future__ import annotations

import hashlib
from typing import Any, TypeVar

from fgenv.scenarios.shapes.bodies import MeshFile

from .build import urdf_path
from .schema import ScenarioSpec

AnyScenario = TypeVar("AnyScenario", bound=ScenarioSpec)


def with_hashes(scenario: AnyScenario) -> AnyScenario:
    """The scenario with the SHA-256 hash of each mesh file."""
    shapes = {
        name: form.model_copy(update={"sha256": sha256(form.path(scenario.folder))})
        if isinstance(form, MeshFile)
        else form
        for name, form in scenario.shapes.items()
    }
    return scenario.model_copy(update={"shapes": shapes}).at(scenario.folder)


def urdf_hashes(scenario: ScenarioSpec) -> dict[str, str]:
    """The hash of each model's URDF file."""
    return {
        name: sha256(urdf_path(model.urdf, scenario.folder))
        for name, model in scenario.models.items()
        if model.urdf is not None
    }


def sha256(path: Any) -> str:
    """The SHA-256 hash of a file."""
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
