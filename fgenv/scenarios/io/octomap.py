"""OctoMap files (.bt, .ot): the occupied leaves of an octree, as boxes.

A. Hornung et al.: OctoMap: an efficient probabilistic 3D mapping framework based on octrees.
Autonomous Robots 34 (3), 2013. The reader is our own: it bounds depth and size, which the library
takes from the file.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Annotated, Any, NoReturn

import numpy as np
from numpy.typing import NDArray
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
Keys = NDArray[np.int64]


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
    low = leaves[:, :3] - CENTER
    boxes = merged_boxes(np.concatenate([low, low + leaves[:, 3:]], axis=1)) * resolution
    count = f"{len(leaves)} occupied leaves"
    return scenario_of_boxes(
        path, boxes, "octomap", description=f"Octree of {count}, {resolution:g} m."
    )


def read_octree(path: Path, threshold: float = 0.5) -> tuple[Keys, float]:
    """Occupied leaves (n, 4), lower corners and edges in keys, and the edge of a key (m)."""
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
        return np.zeros((0, 4), dtype=np.int64), resolution
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


def binary_leaves(path: Path, data: bytes, start: int) -> tuple[Keys, int, int]:
    """Occupied leaves of a .bt tree, its number of nodes, and where it ends.

    A record of an inner node has two bits for each child: 00 is unknown, 01 free, 10 occupied, 11
    inner.
    """
    words = np.frombuffer(data[start : start + (len(data) - start) // 2 * 2], dtype="<u2")
    states = words[:, None] >> np.arange(0, 16, 2) & 3
    records, levels = _levels(path, states == 3, 2)
    leaves = [
        np.column_stack([corners(keys[at], edge, child), np.full(len(at), edge // 2)])
        for nodes, keys, edge in levels
        for at, child in [np.nonzero(states[nodes] == 2)]
    ]
    nodes = 1 + int(np.count_nonzero(states[:records]))
    return np.concatenate(leaves), nodes, start + 2 * records


def full_leaves(
    path: Path, data: bytes, start: int, extra: int, least: float
) -> tuple[Keys, int, int]:
    """Occupied leaves of an .ot tree: log-odds and a bit for each child, of each node."""
    kind = np.dtype([("value", "<f4"), ("extra", "V", extra), ("children", "u1")])
    rows = np.frombuffer(data, kind, (len(data) - start) // kind.itemsize, start)
    inner = (rows["children"][:, None] >> np.arange(8) & 1).astype(bool)
    records, levels = _levels(path, inner, 1)
    leaves = []
    for nodes, keys, edge in levels:
        occupied = ~inner[nodes].any(axis=1) & ~(rows["value"][nodes] < least)  # NaN is occupied
        leaves.append(np.column_stack([keys[occupied], np.full(occupied.sum(), edge)]))
    return np.concatenate(leaves), records, start + kind.itemsize * records


def corners(keys: Keys, edge: int, child: NDArray[np.integer[Any]]) -> Keys:
    """Lower corners (n, 3) of children, by their numbers (n,), of nodes of an edge."""
    return keys + edge // 2 * (child[:, None] >> np.arange(3) & 1)


def _levels(
    path: Path, inner: NDArray[np.bool_], smallest: int
) -> tuple[int, list[tuple[NDArray[np.int64], Keys, int]]]:
    """Number of records of a tree, and records, lower corners and edge of the nodes of each level.

    Records are in preorder. Before record k, `waiting` nodes are to come; a subtree ends at the
    first record after it with one fewer.

    Args:
        inner: (n, 8), whether each child of each record has a record.
        smallest: edge of the smallest node that has a record.
    """
    counts = inner.sum(axis=1, dtype=np.int64)
    waiting = np.concatenate([[1], 1 + np.cumsum(counts - 1)])
    records = int(np.argmax(waiting == 0))
    if waiting[records] != 0:
        _fail_truncated(path)
    n = records + 1
    order = np.sort(waiting[:n] * n + np.arange(n))
    ends = order[np.searchsorted(order, (waiting[:n] - 1) * n + np.arange(n), "right") % n] % n
    nodes, keys, edge = np.zeros(1, dtype=np.int64), np.zeros((1, 3), dtype=np.int64), 1 << DEPTH
    levels = []
    while len(nodes):
        levels.append((nodes, keys, edge))
        following, below = nodes + 1, []
        for child in range(8):
            at = np.flatnonzero(inner[nodes, child])
            below.append((following[at], corners(keys[at], edge, np.full(len(at), child))))
            following[at] = ends[following[at]]
        nodes = np.concatenate([node for node, _ in below])
        keys = np.concatenate([key for _, key in below])
        edge //= 2
        if len(nodes) and edge < smallest:
            fail(path, f"has more than {DEPTH} levels", f"expected a tree of {DEPTH} levels")
    return records, levels


def _fail_truncated(path: Path) -> NoReturn:
    fail(path, "ends within the tree", "the file is truncated: get it again")
