"""Files that are no mesh, or a damaged one: one line that names the fault and the place."""

from __future__ import annotations

import gzip
import re
import socket
import struct
import tracemalloc
import zipfile
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from support.mesh_files import (
    INDICES,
    PLY_KINDS,
    XYZ,
    binary_stl,
    facets,
    mesh_cases,
    off,
    ply_faces,
    ply_header,
    ply_vertices,
    prism,
    prism_triangles,
    zipped,
)

from fgenv.collision import Shape
from fgenv.collision.mesh_files import archive, files

FORMATS = ["stl", "obj", "ply", "off", "glb", "dae", "3mf"]
TRIANGLE = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"


def refused(path: Path, *words: str) -> None:
    """Assert an error of one line that names the file and has every pattern."""
    with pytest.raises((ValueError, FileNotFoundError)) as caught:
        Shape.load(path)
    text = str(caught.value)
    assert str(path) in text
    assert "\n" not in text
    assert len(text) < len(str(path)) + 400
    for word in words:
        assert re.search(word, text), f"{text!r} does not contain {word!r}"


def write(folder: Path, name: str, content: str | bytes) -> Path:
    path = folder / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


# Content of another kind

LFS = "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 123\n"
CONTENTS: dict[str, tuple[str | bytes, str]] = {
    "a Git LFS pointer": (LFS, "Git LFS pointer.*git lfs pull"),
    "a git-annex pointer": ("/annex/objects/MD5-s1--0\n", "git-annex"),
    "a page": ("<!DOCTYPE html>\n<html></html>", "HTML page"),
    "a page after spaces": ("\n\n  <HTML><body>404</body>", "HTML page"),
    "UTF-16": ("solid a\n".encode("utf-16"), "UTF-16"),
    "zeros": (b"\0" * 500, "zeros"),
    "spaces": (" \n" * 500, "spaces"),
    "nothing": (b"", "empty"),
}


@pytest.mark.parametrize("suffix", FORMATS)
@pytest.mark.parametrize("content", CONTENTS)
def test_content_of_another_kind(content: str, suffix: str, tmp_path: Path) -> None:
    data, words = CONTENTS[content]
    refused(write(tmp_path, f"part.{suffix}", data), words)


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (b"ply\nformat ascii 1.0\n" + b" " * 90, "PLY file.*rename"),
        (b"glTF" + b"\2\0\0\0" * 30, "glTF.*rename"),
        (gzip.compress(b"solid a" * 20, mtime=0), "gzip.*rename"),
        (zipped(("a.stl", b"solid a" * 99)), "zip.*rename"),
    ],
)
def test_a_format_under_the_suffix_of_another(data: bytes, words: str, tmp_path: Path) -> None:
    for suffix in ("stl", "obj", "off"):
        refused(write(tmp_path, f"part.{suffix}", data), words)


def test_a_socket(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)  # the path of a socket has at most 107 bytes
    with socket.socket(socket.AF_UNIX) as server:
        server.bind("part.stl")
        refused(Path("part.stl"), "device or pipe")


def test_a_file_that_is_too_large_is_not_read(tmp_path: Path) -> None:
    path = tmp_path / "part.stl"
    with path.open("wb") as file:
        file.truncate(files.MAX_BYTES + 1)
    refused(path, "has 4,294,967,297 bytes", "at most")


@pytest.mark.parametrize(
    ("suffix", "words"),
    [
        ("step", "CAD"), ("svg", "drawing"), ("xyz", "point cloud"), ("fbx", "GLB"),
        ("bz2", "unpack"), ("tar.gz", "unpack"), ("docx", "unknown format"), ("", "no suffix"),
    ],
)  # fmt: skip
def test_formats_that_are_not_read(suffix: str, words: str, tmp_path: Path) -> None:
    content = gzip.compress(b"x" * 9, mtime=0) if suffix.endswith("gz") else b"words"
    path = write(tmp_path, f"part.{suffix}" if suffix else "part", content)
    refused(path, words, r"expected one of \.3mf, .*\.stl.*\.zip")


# STL


def test_sizes_of_binary_stl(tmp_path: Path) -> None:
    mesh = prism_triangles()
    whole = binary_stl(*mesh)
    for size in (84, 85, 84 + 50, len(whole) - 50, len(whole) - 1):
        refused(write(tmp_path, "cut.stl", whole[:size]), "truncated", "of the 20 in its header")
    for more in (1, 49, 50, 5000):
        long = write(tmp_path, "long.stl", whole + b"\1" * more)
        refused(long, f"{more} bytes after the 20 faces")
    refused(write(tmp_path, "short.stl", b"x" * 70), "70 bytes", "header of 84")
    for count in (0, 0xFFFFFFFF):
        path = write(tmp_path, "unfinished.stl", binary_stl(*mesh, count=count))
        refused(path, f"header with {count} faces before 20 faces", "did not finish")
    refused(write(tmp_path, "few.stl", binary_stl(*mesh, count=19)), "50 bytes after the 19")
    refused(write(tmp_path, "many.stl", binary_stl(*mesh, count=21)), "20 whole faces of the 21")
    solid = binary_stl(*mesh, header=b"solid")
    refused(write(tmp_path, "solid.stl", solid[:-1]), "truncated", "header")
    refused(write(tmp_path, "none.stl", binary_stl(mesh[0], mesh[1][:0], header=b"x")), "no faces")


BODY = facets(*prism_triangles())
TEXT_STL: dict[str, tuple[str, tuple[str, ...]]] = {
    "a bad number": (BODY.replace("vertex 2 0", "vertex 2 x0", 1), ("line 5:", "'x0'", "number")),
    "two numbers": (BODY.replace("vertex 1 1 0", "vertex 1 1", 1), ("line", "2 numbers")),
    "four numbers": (BODY.replace("vertex 1 1 0", "vertex 1 1 0 0", 1), ("4 numbers",)),
    "NaN": (BODY.replace("vertex 1 1 0", "vertex 1 nan 0", 1), ("line", "vertex.*nan")),
    "two vertices": (
        BODY.replace("      vertex 2 1 0\n", "", 1), ("line 6:", "endloop", "expected.*vertex")),
    "four vertices": (
        BODY.replace("    endloop", "      vertex 0 0 0\n    endloop", 1), ("line 7", "endloop")),
    "no loop": (BODY.replace("    outer loop\n", "", 1), ("line 3", "outer")),
    "a word": (BODY.replace("endfacet", "endfact", 1), ("line 8", "'endfact'")),
    "an early end": (BODY.replace("  endfacet\n", "endsolid\n", 1), ("line 8", "endfacet")),
}  # fmt: skip


@pytest.mark.parametrize("fault", TEXT_STL)
def test_faults_of_text_stl(fault: str, tmp_path: Path) -> None:
    body, words = TEXT_STL[fault]
    refused(write(tmp_path, "part.stl", f"solid\n{body}endsolid\n"), *words)


def test_text_stl_cut_at_any_place(tmp_path: Path) -> None:
    """Between two facets a file is complete; anywhere else it is truncated."""
    text = f"solid a\n{BODY}endsolid a\n"
    starts = [m.end() for m in re.finditer("endfacet", text)]
    for size in range(text.index("facet") + 3, len(text) - 12, 29):
        path = write(tmp_path, "cut.stl", text[:size])
        last = max([s for s in starts if s <= size], default=0)
        if text[last:size].strip():
            refused(path, "line")
        else:
            assert len(Shape.load(path).faces) == starts.index(last) + 1
    refused(write(tmp_path, "cut.stl", text[: starts[3] - 20]), "truncated")


def test_a_solid_without_facets(tmp_path: Path) -> None:
    refused(write(tmp_path, "part.stl", "solid a\nendsolid a\n"), "no faces")


# OBJ

OBJ_FAULTS: dict[str, tuple[str, tuple[str, ...]]] = {
    "index 0": (TRIANGLE + "f 0 1 2\n", ("line 4:", "index 0", "from 1")),
    "too large": (TRIANGLE + "f 1 2 4\n", ("line 4:", "index 4", "3 vertices")),
    "too far back": (TRIANGLE + "f -1 -2 -4\n", ("line 4:", "index -4", "3 vertices")),
    "before the vertices": ("f -1 -2 -3\n" + TRIANGLE, ("line 1:", "index -1|index -3")),
    "no index": (TRIANGLE + "f 1 2 x\n", ("line 4:", "'x'", "index")),
    "a fraction": (TRIANGLE + "f 1 2 3.5\n", ("line 4:", "'3.5'")),
    "huge": (TRIANGLE + "f 1 2 99999999999999999999\n", ("line 4:", "index")),
    "reference only": (TRIANGLE + "f /1 /2 /3\n", ("line 4:|no faces",)),
    "cut in a face": (TRIANGLE + "f 1 2 3\nf 1 2", ("line 5:", "truncated")),
    "a bad number": ("v 0 0 0\nv 1 zero 0\n", ("line 2:", "'zero'")),
    "two numbers": ("v 0 0 0\nv 1 0\nv 0 1 0\nf 1 2 3\n", ("line 2:", "2 numbers")),
    "five numbers": ("v 0 0 0 1 1\n", ("line 1:", "5 numbers")),
    "infinite": (TRIANGLE.replace("1 0 0", "1 -inf 0") + "f 1 2 3\n", ("line 2:", "-inf")),
    "a curve": (TRIANGLE + "curv 0 1 1 2 3\n", ("line 4:", "curv", "free-form")),
    "a surface": (TRIANGLE + "cstype bspline\nsurf 0 1 0 1 1 2 3\n", ("line 4:", "free-form")),
    "a call": ("call other.obj\n", ("line 1:", "call")),
    "a keyword": (TRIANGLE + "face 1 2 3\n", ("line 4:", "'face'")),
    "continued": ("v 0 \\\n0 0\nv 1 \\\n 0 x\n", ("line 3:", "'x'")),
    "no faces": (TRIANGLE, ("no faces", "3 vertices")),
    "lines only": (TRIANGLE + "l 1 2 3\n", ("no faces", "polylines")),
    "no area": (TRIANGLE + "f 1 1 1\n", ("zero area",)),
    "words": ("not a mesh at all\n", ("line 1:", "'not'")),
}


@pytest.mark.parametrize("fault", OBJ_FAULTS)
def test_faults_of_obj(fault: str, tmp_path: Path) -> None:
    text, words = OBJ_FAULTS[fault]
    refused(write(tmp_path, "part.obj", text), *words)


# PLY


def ply(kind: str, vertex_count: int = 12, face_count: int = 8, tail: bytes = b"") -> bytes:
    vertices, polygons = prism()
    head = [("vertex", vertex_count, XYZ), ("face", face_count, INDICES)]
    body = ply_vertices(vertices, kind) + ply_faces(polygons, kind)
    return ply_header(kind, head) + body + tail


@pytest.mark.parametrize("kind", PLY_KINDS)
def test_sizes_of_ply(kind: str, tmp_path: Path) -> None:
    whole = ply(kind)
    for size in (len(whole) - 6, len(whole) - 40, len(whole) - 100):
        refused(write(tmp_path, "cut.ply", whole[:size]), "truncated|'.*'", "face|vertex|number")
    refused(write(tmp_path, "long.ply", whole + b"1 2 3 4\n"), "after the elements")
    refused(write(tmp_path, "few.ply", ply(kind, face_count=7)), "after the elements")
    refused(write(tmp_path, "many.ply", ply(kind, face_count=9)), "truncated", "9 elements face")
    for count in (10**6, 10**15, 2**64):
        refused(write(tmp_path, "claim.ply", ply(kind, count)), "truncated", "elements vertex")
        refused(write(tmp_path, "claim.ply", ply(kind, 12, count)), "truncated", "elements face")


@pytest.mark.parametrize("kind", PLY_KINDS)
@pytest.mark.parametrize(
    ("faces", "words"),
    [
        ([[0, 1, 12]], "index 12, out of range, in face 0"),
        ([[0, 1, 2], [0, 1, 2, -1]], "index -1, out of range, in face 1"),
        ([[0, 1, 2], [0, 1]], r"face 1 \(from 0\) with 2 corners"),
        ([[]], "with 0 corners"),
    ],
)
def test_faces_of_ply(kind: str, faces: list[list[int]], words: str, tmp_path: Path) -> None:
    head = ply_header(kind, [("vertex", 12, XYZ), ("face", len(faces), INDICES)])
    body = ply_vertices(prism()[0], kind) + ply_faces(faces, kind)
    refused(write(tmp_path, "part.ply", head + body), words)


@pytest.mark.parametrize("kind", PLY_KINDS)
def test_vertices_of_ply(kind: str, tmp_path: Path) -> None:
    vertices = prism()[0]
    vertices[5, 1] = np.nan
    head = ply_header(kind, [("vertex", 12, XYZ), ("face", 8, INDICES)])
    body = ply_vertices(vertices, kind) + ply_faces(prism()[1], kind)
    refused(write(tmp_path, "part.ply", head + body), "vertex 5", "nan")
    head = ply_header(kind, [("vertex", 12, ("float x", "float y")), ("face", 8, INDICES)])
    refused(write(tmp_path, "flat.ply", head + body), "property z")
    head = ply_header(kind, [("vertex", 12, XYZ)])
    refused(write(tmp_path, "cloud.ply", head + ply_vertices(prism()[0], kind)), "no faces")


HEADERS = {
    "ply\nformat ascii 2.0\nend_header\n": ("line 2:", "ascii"),
    "ply\nformat binary 1.0\nend_header\n": ("line 2:", "binary_little_endian"),
    "ply\nend_header\n": ("format",),
    "ply\nformat ascii 1.0\nelement vertex\nend_header\n": ("line 3:", "element"),
    "ply\nformat ascii 1.0\nelement vertex -3\nend_header\n": ("line 3:", "element"),
    "ply\nformat ascii 1.0\nelement a 1\nelement a 1\nend_header\n": ("line 4:", "twice"),
    "ply\nformat ascii 1.0\nproperty float x\nend_header\n": ("line 3:", "element first"),
    "ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\n": ("line 4:", "half"),
    "ply\nformat ascii 1.0\nelement a 1\nproperty list float int b\n": ("line 4:", "float"),
    "ply\nformat ascii 1.0\nelement a 1\nproperty int b\nproperty int b\n": ("line 5:", "twice"),
    "ply\nformat ascii 1.0\nelements 3\n": ("line 3:", "'elements'"),
    "ply\nformat ascii 1.0\n": ("line 3:", "end_header"),
    "plyx\nformat ascii 1.0\n": ("line 1:", "ply"),
    "ply\nformat ascii 1.0\nelement face 0\nend_header\n": ("element vertex",),
}


@pytest.mark.parametrize("header", HEADERS)
def test_headers_of_ply(header: str, tmp_path: Path) -> None:
    refused(write(tmp_path, "part.ply", header), *HEADERS[header])


def test_words_in_text_ply(tmp_path: Path) -> None:
    text = ply("ascii").decode().replace("\n1 1 0\n", "\n1 one 0\n")
    refused(write(tmp_path, "part.ply", text), "line 14:", "'one'")


# OFF

PLAIN = off(*prism())
OFF_FAULTS: dict[str, tuple[str, tuple[str, ...]]] = {
    "binary": ("OFF BINARY\n\0\0", ("line 1:", "binary OFF")),
    "binary below": ("OFF\nBINARY\n", ("line 2:", "binary OFF")),
    "four numbers": ("4OFF\n1 0 0\n0 0 0 1\n", ("line 1:", "4OFF")),
    "n numbers": ("nOFF\n5\n1 0 0\n", ("line 1:", "nOFF")),
    "words": ("not a mesh\n", ("line 1:", "'not'", "OFF")),
    "comments": ("# nothing\n", ("nothing but comments",)),
    "no counts": ("OFF\n", ("numbers of vertices",)),
    "bad counts": ("OFF\n12 eight 0\n", ("line 2:", "12 eight")),
    "negative": ("OFF\n-12 8 0\n", ("line 2:", "-12")),
    "few vertices": (PLAIN.replace("12 8", "11 8"), ("20 lines", "19", "line 2")),
    "many vertices": (PLAIN.replace("12 8", "999999999999 8"), ("20 lines", "line 2")),
    "few faces": (PLAIN.replace("12 8", "12 7"), ("20 lines", "19")),
    "many faces": (PLAIN.replace("12 8", "12 9"), ("20 lines", "21")),
    "an index": (PLAIN.replace("4 0 1 7 6", "4 0 1 12 6"), ("line 17:", "12", "0 to 11")),
    "below 0": (PLAIN.replace("4 0 1 7 6", "4 0 1 -1 6"), ("line 17:", "-1")),
    "a fraction": (PLAIN.replace("4 0 1 7 6", "4 0 1 7.5 6"), ("line 17:", "7.5")),
    "few corners": (PLAIN.replace("4 0 1 7 6", "4 0 1 7"), ("line 17:", "4 corners")),
    "no corners": (PLAIN.replace("4 0 1 7 6", "0"), ("line 17:", "0 corners")),
    "two numbers": (PLAIN.replace("2 1 0\n", "2 1\n", 1), ("line 4:", "2 numbers")),
    "a bad number": (PLAIN.replace("2 1 0\n", "2 one 0\n", 1), ("line 4:", "'one'")),
    "NaN": (PLAIN.replace("2 1 0\n", "2 nan 0\n", 1), ("line 4:", "nan")),
    "no faces": ("OFF\n1 0 0\n0 0 0\n", ("no faces",)),
    "empty": ("OFF\n0 0 0\n", ("no faces",)),
}


@pytest.mark.parametrize("fault", OFF_FAULTS)
def test_faults_of_off(fault: str, tmp_path: Path) -> None:
    text, words = OFF_FAULTS[fault]
    refused(write(tmp_path, "part.off", text), *words)


def test_lines_are_counted_with_comments(tmp_path: Path) -> None:
    text = "# a\n\n" + PLAIN.replace("4 0 1 7 6", "# b\n4 0 1 99 6")
    refused(write(tmp_path, "part.off", text), "line 20:", "99")


# Packed files


def test_archives_with_no_mesh_or_several(tmp_path: Path) -> None:
    stl = binary_stl(*prism_triangles())
    two = zipped(("a.stl", stl), ("b/c.obj", b"v"), ("d.txt", b"d"))
    refused(write(tmp_path, "two.zip", two), "2 meshes", "a.stl, b/c.obj", "exactly one")
    refused(write(tmp_path, "none.zip", zipped(("d.txt", b"d"))), "no mesh", "d.txt")
    refused(write(tmp_path, "nothing.zip", zipped()), "no mesh|empty")
    many = zipped(*((f"{i}.stl", stl) for i in range(99)))
    refused(write(tmp_path, "many.zip", many), "99 meshes", r"4\.stl, \.\.\.")


def test_damaged_archives(tmp_path: Path) -> None:
    stl = binary_stl(*prism_triangles())
    whole = zipped(("a.stl", stl))
    refused(write(tmp_path, "cut.zip", whole[:-30]), "damaged zip")
    place = whole.index(b"a.stl") + 20
    changed = whole[:place] + bytes([whole[place] ^ 0x55]) + whole[place + 1 :]
    refused(write(tmp_path, "changed.zip", changed), "damaged|truncated")
    refused(write(tmp_path, "words.zip", b"words"), "damaged zip")
    packed = gzip.compress(stl, mtime=0)
    refused(write(tmp_path, "cut.stl.gz", packed[:-20]), "truncated gzip")
    refused(write(tmp_path, "sum.stl.gz", packed[:-8] + b"\0" * 8), "damaged gzip")
    refused(write(tmp_path, "words.stl.gz", b"words"), "damaged gzip")
    refused(write(tmp_path, "part.gz", packed), r"without the suffix.*part\.stl\.gz")
    refused(write(tmp_path, "nothing.stl.gz", gzip.compress(b"", mtime=0)), "nothing but")


def test_faults_inside_archives_name_the_archive(tmp_path: Path) -> None:
    bad = (TRIANGLE + "f 1 2 4\n").encode()
    refused(write(tmp_path, "bad.zip", zipped(("a.obj", bad))), "line 4:", "index 4")
    refused(write(tmp_path, "bad.obj.gz", gzip.compress(bad, mtime=0)), "line 4:", "index 4")
    refused(write(tmp_path, "lfs.zip", zipped(("a.stl", LFS.encode()))), "Git LFS")


def test_encrypted_archives(tmp_path: Path) -> None:
    whole = bytearray(zipped(("a.stl", b"x" * 99)))
    whole[6] |= 1
    whole[whole.index(b"PK\1\2") + 8] |= 1
    refused(write(tmp_path, "part.zip", bytes(whole)), "encrypted")


def test_bombs_are_not_inflated(tmp_path: Path) -> None:
    """Zeros pack a thousandfold: the memory stays near the bound."""
    zeros = gzip.compress(b"\0" * (64 << 20))
    member = zipped(("a.stl", b"\0" * (64 << 20)))
    lying = bytearray(member)  # states a size of 100 bytes
    for mark, offset in ((b"PK\3\4", 22), (b"PK\1\2", 24)):
        place = lying.index(mark) + offset
        lying[place : place + 4] = struct.pack("<I", 100)
    paths = [
        write(tmp_path, "bomb.stl.gz", zeros),
        write(tmp_path, "bomb.zip", member),
        write(tmp_path, "lying.zip", bytes(lying)),
    ]
    tracemalloc.start()
    try:
        for path, words in zip(
            paths, ("unpacks to over", "unpacks to over", "damaged"), strict=True
        ):
            refused(path, words)
        assert tracemalloc.get_traced_memory()[1] < 3 * archive.SMALL
    finally:
        tracemalloc.stop()


def test_an_archive_that_states_huge_sizes(tmp_path: Path) -> None:
    """The packed size is at most that of the file, whatever the archive states."""
    path = tmp_path / "overlap.zip"
    with zipfile.ZipFile(path, "w") as out:
        out.writestr("a.stl", b"x")
        out.infolist()[0].compress_size = 1 << 40
        out.infolist()[0].file_size = 1 << 40
    refused(path, "unpacks to over|damaged")


# Any bytes

SMALL = [case for case in mesh_cases() if len(case.content) < 3000]


@settings(max_examples=300, suppress_health_check=list(HealthCheck))
@given(data=st.data())
@pytest.mark.filterwarnings("ignore::fgenv.collision.MeshWarning")
def test_damaged_files_are_read_or_refused(data: st.DataObject, tmp_path: Path) -> None:
    """Bytes changed, removed or repeated: a sound shape, or one line."""
    case = data.draw(st.sampled_from(SMALL))
    content = bytearray(case.content)
    for _ in range(data.draw(st.integers(1, 4))):
        place = data.draw(st.integers(0, len(content) - 1))
        end = min(len(content), place + data.draw(st.integers(0, 20)))
        new = data.draw(
            st.binary(max_size=6) | st.sampled_from([b"-1", b"nan", b"99", b"\n", b"#"])
        )
        content[place:end] = new
        if not content:
            return
    path = write(tmp_path, case.name, bytes(content))
    try:
        shape = Shape.load(path)
    except ValueError:
        refused(path)
    else:
        assert np.isfinite(shape.vertices).all()
