"""OctoMap files (.bt, .ot): the occupied leaves of an octree, as boxes.

A. Hornung et al.: OctoMap: an efficient probabilistic 3D mapping framework based on octrees.
Autonomous Robots 34 (3), 2013. The reader is our own: it bounds depth and size, which the library
takes from the file.
"""

from __future__ import annotations

import math
import struct
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import Field

from fgenv.scenarios.errors import cut
from fgenv.scenarios.registry import file_format
from fgenv.scenarios.scenario import Scenario
from fgenv.scenarios.shapes.boxes import merged_boxes

from .grids import count_in, fail, file_error, number_in, read_bytes, scenario_of_boxes

DEPTH = 16  # levels below the root
CENTER = 1 << (DEPTH - 1)  # key of the origin
HEADS = {b"# Octomap OcTree binary file": True, b"# Octomap OcTree file": False}  # is a .bt
EXTRA_BYTES = {"OcTree": 0, "ColorOcTree": 3, "OcTreeStamped": 4}  # of a node, after its log-odds
MAX_NODES = 50_000_000
Share = Annotated[float, Field(gt=0, lt=1, strict=True, allow_inf_nan=False)]
Leaf = tuple[int, int, int, int]  # lower x, y, z and edge, in keys


@file_format("OctoMap", ".bt", ".ot")
def octomap(path: Path, threshold: Share = 0.5) -> Scenario:
    """The occupied leaves of an octree, as one body of merged boxes; unknown space is free.

    Args:
        threshold: probability from which a leaf of an .ot file is occupied; a .bt file has the
            decision of the program that wrote it.

    Raises:
        ScenarioError: another file, a truncated one, or a tree that is not supported.
    """
    leaves, resolution = read_octree(path, threshold)
    keys = np.array(leaves, dtype=np.int64).reshape(-1, 4)
    low = keys[:, :3] - CENTER
    boxes = merged_boxes(np.concatenate([low, low + keys[:, 3:]], axis=1)) * resolution
    count = f"{len(keys)} occupied leaves"
    return scenario_of_boxes(
        path, boxes, "octomap", description=f"Octree of {count}, {resolution:g} m."
    )


def read_octree(path: Path, threshold: float = 0.5) -> tuple[list[Leaf], float]:
    """Occupied leaves, and the edge of the smallest one (m)."""
    data = read_bytes(path)
    first, _, _ = data[:200].partition(b"\n")
    if first.strip() not in HEADS:
        fail(
            path,
            f"begins with {cut(repr(first), 40)}",
            f"expected {next(iter(HEADS)).decode()!r}",
            1,
        )
    binary = HEADS[first.strip()]
    head, start = header(path, data)
    if head.get("id", "OcTree") not in EXTRA_BYTES:
        fail(
            path, f"is a tree of type {cut(head['id'], 40)!r}", f"expected {', '.join(EXTRA_BYTES)}"
        )
    resolution = number_in(path, head["res"], 1)
    size = count_in(path, head["size"], 1, MAX_NODES)
    if resolution <= 0:
        fail(path, f"has resolution {resolution:g}", "expected a length over 0")
    if size == 0:
        return [], resolution
    if binary:
        leaves, nodes, end = binary_leaves(path, data, start)
    else:
        least = math.log(threshold / (1.0 - threshold))
        leaves, nodes, end = full_leaves(path, data, start, EXTRA_BYTES[head["id"]], least)
    if nodes != size or data[end:].strip():
        text = f"has {nodes} nodes and {len(data) - end} bytes after them"
        fail(path, text, f"expected {size} nodes, as its header says")
    return leaves, resolution


def header(path: Path, data: bytes) -> tuple[dict[str, str], int]:
    """The fields of the header, and where the tree begins."""
    fields: dict[str, str] = {}
    position = 0
    for number in range(1, 1000):
        end = data.find(b"\n", position)
        if end < 0:
            break
        line = data[position:end].decode("utf-8", "replace").strip()
        position = end + 1
        key, _, value = line.partition(" ")
        if key == "data":
            for needed in ("size", "res"):
                if needed not in fields:
                    fail(path, f"has no {needed} in its header", "save it again")
            return {"id": "OcTree", **fields}, position
        if line and not line.startswith("#"):
            if key not in ("id", "size", "res"):
                fail(path, f"got {cut(line, 40)!r}", "expected id, size, res or data", number)
            fields[key] = value.strip()
    raise file_error(path, "has no data", "save it again")


def children(key: tuple[int, int, int], edge: int) -> list[tuple[int, int, int]]:
    """Lower corners of the eight children of a node of an edge."""
    x, y, z = key
    h = edge // 2
    return [(x + h * (i & 1), y + h * (i >> 1 & 1), z + h * (i >> 2)) for i in range(8)]


def binary_leaves(path: Path, data: bytes, start: int) -> tuple[list[Leaf], int, int]:
    """Occupied leaves of a .bt tree, its number of nodes, and where it ends.

    An inner node has two bits for each child: 00 is unknown, 01 free, 10 occupied, 11 inner.
    """
    leaves: list[Leaf] = []
    stack, nodes, position = [((0, 0, 0), 1 << DEPTH)], 1, start
    while stack:
        key, edge = stack.pop()
        if position + 2 > len(data) or edge < 2:
            _damaged(path, edge)
        bits = data[position] | data[position + 1] << 8
        position += 2
        inner = []
        for i, child in enumerate(children(key, edge)):
            state = bits >> (2 * i) & 3
            nodes += state != 0
            if state == 3:
                inner.append((child, edge // 2))
            elif state == 2:
                leaves.append((*child, edge // 2))
        stack += reversed(inner)
    return leaves, nodes, position


def full_leaves(
    path: Path, data: bytes, start: int, extra: int, least: float
) -> tuple[list[Leaf], int, int]:
    """Occupied leaves of an .ot tree: log-odds and a bit for each child, of each node."""
    leaves: list[Leaf] = []
    stack, nodes, position = [((0, 0, 0), 1 << DEPTH)], 0, start
    while stack:
        key, edge = stack.pop()
        if position + 5 + extra > len(data):
            _damaged(path, edge)
        (value,) = struct.unpack_from("<f", data, position)
        bits = data[position + 4 + extra]
        position += 5 + extra
        nodes += 1
        if bits and edge < 2:
            _damaged(path, 1)
        if bits:
            below = [c for i, c in enumerate(children(key, edge)) if bits >> i & 1]
            stack += [(child, edge // 2) for child in reversed(below)]
        elif not value < least:  # NaN is occupied
            leaves.append((*key, edge))
    return leaves, nodes, position


def _damaged(path: Path, edge: int) -> None:
    if edge < 2:
        fail(path, f"has more than {DEPTH} levels", f"expected a tree of {DEPTH} levels")
    fail(path, "ends within the tree", "the file is truncated: get it again")
