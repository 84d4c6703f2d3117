"""Laws of every reader of files: any file is read, or refused by one clear error that names it."""

from __future__ import annotations

import gzip
import io
import os
import tracemalloc
import zipfile
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from support.scene_files import zipped
from support.small_files import SmallFile, small_files

from fgenv.collision import Shape
from fgenv.robots import Robot
from fgenv.robots.robot_file import RobotFile
from fgenv.scenarios import Scenario

pytestmark = pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning")
FILES = {file.name: file for file in small_files()}
CUTS, CHANGES = 20, 60
WORDS = (b"-1", b"nan", b"1e999", b"99999999999", b"\0", b"\n", b'"', b"<", b"[", b"\x1b[31m", b"%")
NO_END = (".obj", ".yaml", ".cfg", ".csv", ".scen")  # without a count of rows, or a last row


@pytest.fixture(params=FILES)
def file(request: pytest.FixtureRequest) -> SmallFile:
    return FILES[request.param]


def refused(file: SmallFile, path: Path) -> None:
    """Assert that a file is refused with little memory."""
    size = path.stat().st_size if path.is_file() else 0
    tracemalloc.start()
    try:
        assert file.outcome(path) is None
        assert tracemalloc.get_traced_memory()[1] < (64 << 20) + 256 * size
    finally:
        tracemalloc.stop()


def test_valid_files(file: SmallFile, tmp_path: Path) -> None:
    """All tests below change a file that is read."""
    assert file.read(file.write(tmp_path)) is not None


# Files that are not regular


def test_only_regular_files_with_content_are_read(file: SmallFile, tmp_path: Path) -> None:
    """A pipe without a writer would block for ever, a device would never end."""
    path = file.path(tmp_path)
    path.unlink(missing_ok=True)
    refused(file, path)
    path.mkdir()
    refused(file, path)
    path.rmdir()
    os.mkfifo(path)
    refused(file, path)
    for target in ("/dev/zero", "/dev/null", str(path), str(path) + "/none"):
        path.unlink()
        path.symlink_to(target)
        refused(file, path)
    path.unlink()
    path.touch()
    refused(file, path)


# Damaged files


def test_files_cut_anywhere(file: SmallFile, tmp_path: Path) -> None:
    """Whatever is cut off is missed, where the format allows it."""
    path, whole = file.write(tmp_path), file.content
    expected, end = facts(file.read(path)), len(whole.rstrip(b"\n"))
    text = whole.isascii()
    for size in {int(size) for size in np.linspace(1, len(whole) - 1, CUTS)}:
        path.write_bytes(whole[:size])
        result = file.outcome(path)
        at_row = not text or whole[size - 1 : size] == b"\n"
        if result is not None and size < end and at_row and path.suffix not in NO_END:
            assert facts(result) == expected or noted(result), f"{size} of {len(whole)} bytes"


def facts(result: Any) -> object:
    """Parts of a result that tell whether something is lost."""
    if isinstance(result, Shape):
        return len(result.faces)
    if isinstance(result, Robot | RobotFile):
        return len(result.links), len(result.joints)
    if isinstance(result, Scenario):
        return result.shapes, result.bodies, result.robots
    return getattr(result, "id", None)


def noted(result: Any) -> bool:
    """Whether the report of a mesh has notes."""
    return isinstance(result, Shape) and result.report is not None and bool(result.report.notes)


def test_files_changed_anywhere(file: SmallFile, tmp_path: Path) -> None:
    """Bits and bytes changed, bytes removed, repeated or inserted."""
    rng = np.random.default_rng(zlib.crc32(file.name.encode()))
    path = file.write(tmp_path)
    for _ in range(CHANGES):
        path.write_bytes(changed(file.content, rng))
        file.outcome(path)


def changed(content: bytes, rng: np.random.Generator) -> bytes:
    """The content with one to three changes."""
    data = bytearray(content)
    for _ in range(int(rng.integers(1, 4))):
        at, kind = int(rng.integers(len(data))), int(rng.integers(5))
        span = slice(at, at + int(rng.integers(1, 12)))
        if kind == 0:
            data[at] ^= 1 << int(rng.integers(8))
        elif kind == 1:
            data[at] = int(rng.integers(256))
        elif kind == 2:
            data[span] = WORDS[int(rng.integers(len(WORDS)))]
        elif kind == 3:
            data[at:at] = data[span]
        elif len(data) > 20:
            del data[span]
    return bytes(data)


# XML

XML = [name for name, file in FILES.items() if b"<?xml" in file.content[:50]]
ENTITY = '<!DOCTYPE a [<!ENTITY e "{}">]>'
BILLION = "".join(f'<!ENTITY e{i} "{f"&e{i - 1};" * 10}">' for i in range(1, 10))
DOCTYPES = {
    "an entity": ENTITY.format("0"),
    "a billion": f'<!DOCTYPE a [<!ENTITY e0 "0">{BILLION}<!ENTITY e "&e9;">]>',
    "itself": ENTITY.format("&e;"),
    "another file": '<!DOCTYPE a [<!ENTITY e SYSTEM "file:///etc/passwd">]>',
    "another definition": '<!DOCTYPE a SYSTEM "file:///dev/zero">',
    "a parameter": '<!DOCTYPE a [<!ENTITY % p SYSTEM "file:///dev/zero"> %p;]>',
}


def with_doctype(xml: bytes, doctype: str) -> Iterator[bytes]:
    """XML with a definition, and with an entity in a text and in an attribute."""
    begin = xml.index(b"?>") + 2
    whole = xml[:begin] + doctype.encode() + xml[begin:]
    yield whole
    if "ENTITY e " in doctype:
        root_end = whole.rindex(b"</")
        yield whole[:root_end] + b"&e;" + whole[root_end:]
        yield whole[:root_end] + b'<extra x="&e;"/>' + whole[root_end:]


@pytest.mark.parametrize("doctype", DOCTYPES)
@pytest.mark.parametrize("name", [*XML, "box.3mf", "box.zae"])
def test_document_types_are_refused(name: str, doctype: str, tmp_path: Path) -> None:
    file = FILES[name]
    for content in edited(file, lambda xml: with_doctype(xml, DOCTYPES[doctype])):
        refused(file, file.write(tmp_path, content))


def edited(file: SmallFile, edit: Callable[[bytes], Iterator[bytes]]) -> Iterator[bytes]:
    """Contents of a file whose XML is changed, in an archive as well."""
    if file.content.startswith(b"<"):
        yield from edit(file.content)
        return
    for chosen, xml in members(file.content).items():
        if b"<?xml" in xml:
            for content in edit(xml):
                yield zipped({**members(file.content), chosen: content})


@pytest.mark.parametrize("name", [*XML, "box.3mf", "box.zae"])
def test_elements_in_elements(name: str, tmp_path: Path) -> None:
    """A parser that calls itself for each would end the process."""
    deep = b"<a>" * 200_000 + b"</a>" * 200_000
    for content in edited(FILES[name], lambda xml: iter([xml[: xml.rindex(b"</")] + deep])):
        refused(FILES[name], FILES[name].write(tmp_path, content))


# Archives

ZIPS = [name for name, file in FILES.items() if file.content.startswith(b"PK")]
GIB = 1 << 30


def members(content: bytes) -> dict[str, bytes]:
    """The members of a zip archive."""
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def deflated_zeros() -> bytes:
    """1 GiB of zeros in 1 MB: the same blocks again and again."""
    packer = zlib.compressobj(9, zlib.DEFLATED, -15)
    block = packer.compress(bytes(GIB >> 6)) + packer.flush(zlib.Z_FULL_FLUSH)
    return block * 64 + zlib.compressobj(9, zlib.DEFLATED, -15).flush()


@pytest.mark.parametrize("name", ZIPS)
def test_zip_bombs(name: str, tmp_path: Path) -> None:
    """Each member in turn is 1 GiB of zeros; the size that the archive states is true, or not."""
    file, packed = FILES[name], deflated_zeros()
    for bomb in members(file.content):
        for size in (GIB, 100):
            out = io.BytesIO()
            with zipfile.ZipFile(out, "w") as archive:
                for member, content in members(file.content).items():
                    archive.writestr(member, packed if member == bomb else content)
                info = archive.getinfo(bomb)
                info.compress_type, info.file_size = zipfile.ZIP_DEFLATED, size
            refused(file, file.write(tmp_path, out.getvalue()))


def test_gzip_bombs(tmp_path: Path) -> None:
    head = gzip.compress(b"", mtime=0)[:10]
    file = FILES["part.stl.gz"]
    refused(file, file.write(tmp_path, head + deflated_zeros() + bytes(8)))


@pytest.mark.parametrize("name", ZIPS)
@pytest.mark.parametrize("pattern", ["../{}", "/{}", "a/../../{}", "..\\{}", "C:\\{}", "."])
def test_members_outside_an_archive(name: str, pattern: str, tmp_path: Path) -> None:
    file, inside = FILES[name], tmp_path / "a" / "b"
    inside.mkdir(parents=True)
    for chosen in members(file.content):
        renamed = {
            pattern.format(m) if m == chosen else m: c for m, c in members(file.content).items()
        }
        path = file.write(inside, zipped(renamed))
        refused(file, path)
        assert [p for p in tmp_path.rglob("*") if p.is_file()] == [path]


def test_members_without_a_name(tmp_path: Path) -> None:
    """zipfile ends a name at its first zero, and fails for the rest."""
    for name in ZIPS:
        for member in members(FILES[name].content):
            content = FILES[name].content.replace(member.encode(), b"\0" + member[1:].encode())
            refused(FILES[name], FILES[name].write(tmp_path, content))


# YAML

YAML = [name for name in FILES if name.endswith(".yaml")]


@pytest.mark.parametrize("name", YAML)
def test_aliases_of_aliases(name: str, tmp_path: Path) -> None:
    levels = "".join(f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]\n" for i in range(1, 10))
    file = FILES[name]
    refused(file, file.write(tmp_path, f"a0: &a0 [0]\n{levels}".encode() + file.content))
    nested = f"a: {'[' * 50_000}{']' * 50_000}\n".encode()
    refused(file, file.write(tmp_path, nested + file.content))


# Counts that a file states

MANY = b"99999999"
COUNTS = [
    ("binary.stl", b"\x14\0\0\0", b"\xff\xff\xff\xff"),
    ("ascii.ply", b"element vertex ", b"element vertex " + MANY),
    ("ascii.ply", b"element face ", b"element face " + MANY),
    ("binary_little_endian.ply", b"element vertex ", b"element vertex " + MANY),
    ("binary_little_endian.ply", b"\x06\x05\0", b"\xff\x05\0"),
    ("ascii_strips.ply", b"tristrips 1", b"tristrips " + MANY),
    ("text.ply", b"element vertex ", b"element vertex " + MANY),
    ("cloud.ply", b"element vertex ", b"element vertex " + MANY),
    ("plain.off", b"12 8 0", MANY + b" 8 0"),
    ("plain.off", b"12 8 0", b"12 99999999 0"),
    ("box.gltf", b'"count": 8', b'"count": ' + MANY),
    ("box.gltf", b'"count": 36', b'"count": ' + MANY),
    ("box.gltf", b'"byteLength": ', b'"byteLength": ' + MANY),
    ("box.glb", b'"count": 36', b'"count": 99'),
    ("box.dae", b'count="', b'count="' + MANY),
    ("walls.map", b"height 3", b"height 8000"),
    ("walls.map", b"width 4", b"width 8000"),
    ("tree.bt", b"size 4", b"size " + MANY),
    ("tree.ot", b"size 4", b"size " + MANY),
    ("ascii.pcd", b"POINTS 2", b"POINTS 40000000"),
    ("binary.pcd", b"POINTS 2", b"POINTS 40000000"),
    ("packed.pcd", b"POINTS 2", b"POINTS 40000000"),
    ("packed.pcd", b"\x18\0\0\0", b"\xff\xff\xff\xff"),
    ("table.scene", b"\n3 1\n", b"\n9999999 9999999\n"),
    ("m.pgm", b"6 5", b"8000 8000"),
    ("m.png", b"\0\0\0\x06\0\0\0\x05", b"\0\0\x20\0\0\0\x20\0"),
]


@pytest.mark.parametrize(("name", "old", "new"), COUNTS)
def test_counts_over_the_size_of_the_file(
    name: str, old: bytes, new: bytes, tmp_path: Path
) -> None:
    """Nothing is allocated for a count before the content is there."""
    file = FILES[name]
    assert old in file.content
    refused(file, file.write(tmp_path, file.content.replace(old, new, 1)))
