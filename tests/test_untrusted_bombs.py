"""Bombs and false claims in files: each reader refuses them with little memory."""

from __future__ import annotations

import gzip
import io
import zipfile
import zlib
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from support.scene_files import zipped
from support.small_files import SmallFile, small_files

pytestmark = pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning")
FILES = {file.name: file for file in small_files()}

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
        file.assert_refused(file.write(tmp_path, content))


def edited(file: SmallFile, edit: Callable[[bytes], Iterator[bytes]]) -> Iterator[bytes]:
    """Contents of a file with changed XML, in an archive as well."""
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
        FILES[name].assert_refused(FILES[name].write(tmp_path, content))


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
            file.assert_refused(file.write(tmp_path, out.getvalue()))


def test_gzip_bombs(tmp_path: Path) -> None:
    head = gzip.compress(b"", mtime=0)[:10]
    file = FILES["part.stl.gz"]
    file.assert_refused(file.write(tmp_path, head + deflated_zeros() + bytes(8)))


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
        file.assert_refused(path)
        assert [p for p in tmp_path.rglob("*") if p.is_file()] == [path]


def test_members_without_a_name(tmp_path: Path) -> None:
    """zipfile ends a name at its first zero, and fails for the rest."""
    for name in ZIPS:
        for member in members(FILES[name].content):
            content = FILES[name].content.replace(member.encode(), b"\0" + member[1:].encode())
            FILES[name].assert_refused(FILES[name].write(tmp_path, content))


# YAML

YAML = [name for name in FILES if name.endswith(".yaml")]


@pytest.mark.parametrize("name", YAML)
def test_aliases_of_aliases(name: str, tmp_path: Path) -> None:
    levels = "".join(f"a{i}: &a{i} [{', '.join([f'*a{i - 1}'] * 10)}]\n" for i in range(1, 10))
    file = FILES[name]
    file.assert_refused(file.write(tmp_path, f"a0: &a0 [0]\n{levels}".encode() + file.content))
    nested = f"a: {'[' * 50_000}{']' * 50_000}\n".encode()
    file.assert_refused(file.write(tmp_path, nested + file.content))


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
    file.assert_refused(file.write(tmp_path, file.content.replace(old, new, 1)))
