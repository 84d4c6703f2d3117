"""Compressed files, inflated within bounds: an archive of a few bytes can unpack to terabytes."""

from __future__ import annotations

import io
import struct
import zipfile
import zlib
from collections.abc import Collection
from pathlib import Path, PurePosixPath, PureWindowsPath

from .content import MeshSource

MAX_RATIO = 200  # of unpacked to packed size; meshes as text stay under 30
SMALL = 16 << 20  # bytes that are unpacked at any ratio
PIECE = 1 << 20
DAMAGE = (  # errors of zipfile
    *(zipfile.BadZipFile, zlib.error, struct.error, EOFError, OSError, ValueError),
    *(NotImplementedError, RuntimeError),
)


def gunzip(source: MeshSource, limit: int) -> MeshSource:
    """The content of a .gz file; its suffix is the one before .gz."""
    suffix = Path(source.path.stem).suffix.lower()
    if not suffix:
        source.fail("a .gz file without the suffix of its mesh", "e.g. part.stl.gz; rename it")
    bound = min(limit, max(SMALL, MAX_RATIO * len(source.data)))
    out = io.BytesIO()
    left = source.data
    while left.strip(b"\0"):  # a file may have several members, and zeros as padding
        inflater = zlib.decompressobj(wbits=31)
        while not inflater.eof:
            try:
                piece = inflater.decompress(left, PIECE)
            except zlib.error:
                source.fail("damaged gzip data", "a complete file; copy or download it again")
            left = inflater.unconsumed_tail
            if not piece and not left and not inflater.eof:
                source.fail("truncated gzip data", "a complete file; copy or download it again")
            out.write(piece)
            if out.tell() > bound:
                _refuse_bomb(source, bound)
        left = inflater.unused_data
    return MeshSource(source.path, suffix, out.getvalue())


def unzip_one(source: MeshSource, formats: Collection[str], limit: int) -> MeshSource:
    """The one mesh of a .zip archive."""
    with open_zip(source) as archive:
        members = [i for i in archive.infolist() if not i.is_dir()]
        meshes = [i for i in members if _suffix(i) in formats and not _hidden(i)]
        if len(meshes) != 1:
            names = ", ".join(i.filename for i in (meshes or members)[:5])
            more = ", ..." if len(meshes or members) > 5 else ""
            count = f"{len(meshes)} meshes" if meshes else "no mesh"
            source.fail(
                f"{count} in the archive ({names}{more})", "exactly one; unpack the archive"
            )
        return MeshSource(
            source.path, _suffix(meshes[0]), read_member(source, archive, meshes[0], limit)
        )


def open_zip(source: MeshSource) -> zipfile.ZipFile:
    """The directory of a zip archive, before anything is inflated."""
    try:
        archive = zipfile.ZipFile(io.BytesIO(source.data))
    except DAMAGE:
        source.fail("a damaged zip archive", "a complete file; copy or download it again")
    for name in archive.namelist():
        path = PureWindowsPath(name)
        if not path.parts or ".." in path.parts or path.anchor:
            source.fail(f"the member {name[:60]!r} without a name inside it", "relative names")
    return archive


def read_member(
    source: MeshSource, archive: zipfile.ZipFile, member: zipfile.ZipInfo, limit: int
) -> bytes:
    """Content of a member; its claimed size is checked before, and holds while it is inflated."""
    bound = min(limit, max(SMALL, MAX_RATIO * min(member.compress_size, len(source.data))))
    if member.file_size > bound:
        _refuse_bomb(source, bound)
    if member.flag_bits & 1:
        source.fail(f"the encrypted member {member.filename}", "no password; unpack the archive")
    try:
        with archive.open(member) as file:
            content = file.read(member.file_size + 1)
    except DAMAGE:
        content = b""
    if len(content) != member.file_size:
        source.fail(
            f"the damaged member {member.filename}", "a complete archive; copy or download it again"
        )
    return content


def _refuse_bomb(source: MeshSource, bound: int) -> None:
    source.fail(
        f"compressed data that unpacks to over {bound >> 20} MiB from {len(source.data)} bytes",
        f"at most {MAX_RATIO} times the size; unpack it if you trust it",
    )


def _suffix(member: zipfile.ZipInfo) -> str:
    return PurePosixPath(member.filename).suffix.lower()


def _hidden(member: zipfile.ZipInfo) -> bool:
    """Whether a member is one of the companions that macOS adds."""
    parts = PurePosixPath(member.filename).parts
    return "__MACOSX" in parts or parts[-1].startswith("._")
