"""MJCF files compiled by MuJoCo."""

from __future__ import annotations

import re
import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from fgenv.printable import printable

from .mjcf_document import DocumentCheck

UNNAMED = "MuJoCo Model"  # MuJoCo's name of a model without a name
ARENA = 1 << 28  # bytes: enough for the kinematics of any model, whatever the file asks for
EXPECTED = "a model that MuJoCo compiles"


def compiled_model(path: Path, collision: bool, notes: list[str]) -> Any:
    """The MjModel of a file, with all its bodies, and without textures and keyframes.

    Args:
        collision: a file of a mesh that is only seen may be missing.
        notes: receives sentences on omitted content.

    Raises:
        FileNotFoundError: the file, or a file that it refers to, does not exist.
        ModuleNotFoundError: mujoco is not installed.
        ValueError: invalid content, with file and line.
    """
    try:
        import mujoco
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            f"to read MJCF, {error.name} is needed; remedy: pip install 'fgenv[mjcf]'",
            name=error.name,
        ) from None
    documents = DocumentCheck(path)
    documents.run()
    with _warnings_in(notes, mujoco):
        try:
            return _compiled(mujoco, path)
        except Exception as error:  # ValueError, FatalError, or whatever its parts raise
            fault = _error(path, error, documents.mesh_files())
            if not (collision and isinstance(fault, FileNotFoundError)):
                raise fault from None
            return _without_visual_meshes(mujoco, path, fault, notes)


@contextmanager
def _warnings_in(notes: list[str], mujoco: Any) -> Iterator[None]:
    """Add MuJoCo's warnings to notes; without a handler it writes them to a file."""
    texts: list[str] = []
    handler = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(texts.append)
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            yield
    finally:
        mujoco.set_mju_user_warning(handler)
    texts += [str(warning.message) for warning in caught]
    notes += [f"MuJoCo warns: {_one_line(text)}." for text in dict.fromkeys(texts)]


def _compiled(mujoco: Any, path: Path) -> Any:
    spec = mujoco.MjSpec.from_file(str(path))
    _reduce(spec, mujoco)
    return _without_hulls(spec)


def _without_hulls(spec: Any) -> Any:
    """The compiled model. MuJoCo builds convex hulls of meshes that collide, which are not used."""
    masks = [(geom, geom.contype, geom.conaffinity) for geom in spec.geoms]
    for geom, _, _ in masks:
        geom.contype = geom.conaffinity = 0
    model = spec.compile()
    for geom, kind, affinity in masks:
        model.geom_contype[geom.id], model.geom_conaffinity[geom.id] = kind, affinity
    return model


def _without_visual_meshes(mujoco: Any, path: Path, fault: Exception, notes: list[str]) -> Any:
    """The model without meshes that are only seen; the fault, if that does not cure it."""
    try:
        spec = mujoco.MjSpec.from_file(str(path))
        _reduce(spec, mujoco)
        if spec.compiler.alignfree or any(joint.align == 1 for joint in spec.joints):
            raise fault  # frames of bodies depend on the inertia of all geoms
        pairs = {name for pair in spec.pairs for name in (pair.geomname1, pair.geomname2)}
        for geom in list(spec.geoms):
            meshed = geom.type == mujoco.mjtGeom.mjGEOM_MESH
            if meshed and not (geom.contype or geom.conaffinity or geom.name in pairs):
                body = geom.parent
                if not body.explicitinertial:  # the body may have no mass without the geom
                    body.explicitinertial, body.mass, body.inertia = True, 1.0, [1.0] * 3
                spec.delete(geom)
        used = {geom.meshname for geom in spec.geoms}
        for mesh in list(spec.meshes):
            if (mesh.name or Path(mesh.file).stem) not in used:
                spec.delete(mesh)
        model = _without_hulls(spec)
    except Exception:
        raise fault from None
    notes.append(f"Geoms that do not collide are left out; {fault}.")
    return model


def model_name(model: Any, path: Path) -> str:
    """Name of a model: its own, or the file's."""
    name = bytes(model.names).split(b"\0", 1)[0].decode(errors="replace")
    return path.stem if name in ("", UNNAMED) else name


def _reduce(spec: Any, mujoco: Any) -> None:
    """Keep bodies that MuJoCo would merge; drop parts for pictures and simulation."""
    spec.compiler.fusestatic = False
    spec.compiler.discardvisual = False
    spec.memory, spec.njmax, spec.nconmax = ARENA, -1, -1
    for key in list(spec.keys):
        spec.delete(key)
    for skin in list(spec.skins):
        spec.delete(skin)
    for item in (*spec.geoms, *spec.sites):
        item.material = ""
    for texture in spec.textures:
        texture.file, texture.cubefiles = "", [""] * 6
        texture.builtin = mujoco.mjtBuiltin.mjBUILTIN_FLAT
        texture.width, texture.height = 1, 6 if texture.type else 1


def _error(path: Path, error: Exception, mesh_files: Mapping[str, str]) -> Exception:
    """The error of MuJoCo, with the file and the line first, and the file of a faulty mesh."""
    text = str(error)
    line = re.search(r"line(?: number=|\s+)(\d+)", text, re.IGNORECASE)
    place = f"{path}: line {line[1]}" if line and int(line[1]) else f"path: {path}"
    if missing := re.search(r"[Ee]rror opening file '([^']*)'", text):
        return FileNotFoundError(f"{place}: got no file {missing[1]!r}; put it there")
    element = re.search(r"Element name '([^']*)'", text)
    file = mesh_files.get(element[1]) if element else None
    within = f"mesh file {file!r}: " if file else ""
    return ValueError(f"{place}: {within}got {_one_line(text)}, expected {EXPECTED}")


def _one_line(text: str) -> str:
    short = re.sub(r"^((XML )?Error:\s*)+", "", text.strip())
    return printable(re.sub(r"\s*\n\s*", "; ", short)[:300].rstrip(" .;"))
