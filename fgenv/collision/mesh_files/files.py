"""The bytes of a file that may be untrusted, damaged, compressed, or not a mesh at all."""

from __future__ import annotations

from collections.abc import Collection
from pathlib import Path

from fgenv.file_kind import MESH, other_kind
from fgenv.printable import printable
from fgenv.regular_file import check_regular, read_regular

from .archive import gunzip, unzip_one
from .content import MeshSource

MAX_BYTES = 4 << 30  # of a file, and of its content once unpacked

# First bytes of content that is often stored under a mesh's name, with the remedy.
IMPOSTORS = {
    b"version https://git-lfs": ("a Git LFS pointer", "the mesh itself; run `git lfs pull`"),
    b"/annex/objects/": ("a git-annex pointer", "the mesh itself; run `git annex get`"),
    b"<!doctype html": ("an HTML page", "a mesh; download the raw file"),
    b"<html": ("an HTML page", "a mesh; download the raw file"),
    b"\xff\xfe": ("UTF-16 text", "ASCII or UTF-8; export the mesh again"),
    b"\xfe\xff": ("UTF-16 text", "ASCII or UTF-8; export the mesh again"),
}
# First bytes of the formats that have such a mark, and the suffixes that may begin with it.
MARKS = {
    b"ply\n": ("a PLY file", (".ply",)),
    b"ply\r": ("a PLY file", (".ply",)),
    b"glTF": ("a binary glTF file", (".glb",)),
    b"PK\x03\x04": ("a zip archive", (".zip", ".3mf", ".zae")),
    b"\x1f\x8b": ("gzip data", (".gz",)),
}
# Formats that other programs call meshes, with the remedy.
ELSEWHERE = {
    ".bz2": "unpack it",
    ".xz": "unpack it",
    ".tar": "unpack it",
    ".tgz": "unpack it",
    ".7z": "unpack it",
    ".rar": "unpack it",
    ".stp": "export a mesh from the CAD program, e.g. STL",
    ".step": "export a mesh from the CAD program, e.g. STL",
    ".igs": "export a mesh from the CAD program, e.g. STL",
    ".iges": "export a mesh from the CAD program, e.g. STL",
    ".brep": "export a mesh from the CAD program, e.g. STL",
    ".dxf": "a drawing has no surface; export a mesh, e.g. STL",
    ".svg": "a drawing has no surface; export a mesh, e.g. STL",
    ".xyz": "a point cloud has no surface",
    ".pcd": "a point cloud has no surface",
    ".fbx": "export it as GLB, e.g. with Blender",
    ".blend": "export it as GLB, e.g. with Blender",
    ".wrl": "export it as GLB, e.g. with Blender",
    ".x3d": "export it as GLB, e.g. with Blender",
    ".3ds": "export it as GLB, e.g. with Blender",
    ".xaml": "export it as OBJ or STL",
    ".3dxml": "export it as OBJ or STL",
    ".usd": "export it as GLB or OBJ",
    ".usda": "export it as GLB or OBJ",
    ".usdc": "export it as GLB or OBJ",
    ".usdz": "export it as GLB or OBJ",
    ".msh": "export its surface as STL or OBJ",
    ".vtk": "export its surface as STL or PLY",
    ".vtp": "export its surface as STL or PLY",
}


def open_mesh(path: Path, formats: Collection[str]) -> MeshSource:
    """Read and unpack a file.

    Args:
        formats: suffixes of the formats that are read.

    Raises:
        FileNotFoundError: no such file.
        ValueError: not a regular file, empty, too large, of another format, or damaged.
    """
    source = MeshSource(path, path.suffix.lower(), b"")
    if source.suffix not in {*formats, ".gz", ".zip"} and not path.is_dir():
        check_regular(path, "a mesh file", MAX_BYTES)
        if other := other_kind(path, MESH):
            raise ValueError(printable(f"path: {path}: {other}"))
        refuse_suffix(source, formats)
    source = MeshSource(path, source.suffix, read_mesh_bytes(path))
    if source.suffix == ".gz":
        source = gunzip(source, MAX_BYTES)
    elif source.suffix == ".zip":
        source = unzip_one(source, formats, MAX_BYTES)
    if source.suffix not in formats:
        refuse_suffix(source, formats)
    _check_content(source)
    return source


def refuse_suffix(source: MeshSource, formats: Collection[str]) -> None:
    """Raise the error of a format that is not read, with the remedy if there is one."""
    known = ", ".join(sorted({*formats, ".gz", ".zip"}))
    remedy = ELSEWHERE.get(source.suffix, "export the mesh again")
    name = source.suffix or "no suffix"
    source.fail(f"an unknown format ({name})", f"one of {known}; {remedy}")


def read_mesh_bytes(path: Path) -> bytes:
    """Content of a regular file that is not empty."""
    data = read_regular(path, "a mesh file", MAX_BYTES)
    if not data:
        raise ValueError(f"path: {path} is empty, expected a mesh file")
    return data


def _check_content(source: MeshSource) -> None:
    """Name content that is no mesh, or a mesh of another format than the suffix states."""
    blank = b"\0 \t\r\n"
    if not source.data[:4096].strip(blank) and not source.data.strip(blank):
        source.fail("nothing but spaces or zeros", "a mesh; the file is damaged")
    head = source.data[:256].lstrip(b"\xef\xbb\xbf \t\r\n").lower()
    for mark, (received, expected) in IMPOSTORS.items():
        if head.startswith(mark):
            source.fail(received, expected)
    if other := other_kind(source.path, MESH):
        raise ValueError(printable(f"path: {source.path}: {other}"))
    for mark, (name, suffixes) in MARKS.items():
        if source.data.startswith(mark) and source.suffix not in suffixes:
            source.fail(
                f"{name} with the suffix {source.suffix}", f"the suffix {suffixes[0]}; rename it"
            )
