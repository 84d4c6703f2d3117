"""All mesh files in pip packages, read by us and by independent readers."""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Sequence
from functools import partial
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from time import process_time
from typing import Any

from fgenv.bench.common.meshes import FOLDERS
from fgenv.bench.common.records import Record
from fgenv.collision.mesh_files import READERS, read_mesh_file

from .explanations import AGREES, CONFIRMING, READS, REFUSES, UNIT, explanation
from .readers import PEERS, Measures, fgenv, measured


def files_with(suffixes: Collection[str]) -> list[tuple[str, Path]]:
    """Return label and path of each file with a suffix in the packages; equal content once."""
    seen: set[bytes] = set()
    files = []
    for label, path in sorted(_all_files(suffixes)):
        digest = hashlib.sha256(path.read_bytes()).digest()
        if digest not in seen:
            seen.add(digest)
            files.append((label, path))
    return files


def _all_files(suffixes: Collection[str]) -> Iterator[tuple[str, Path]]:
    for package, (folder, _) in FOLDERS.items():
        try:
            root = Path(str(distribution(package).locate_file(folder)))
        except PackageNotFoundError:
            continue
        for path in root.rglob("*"):
            if path.suffix.lower() in suffixes and path.is_file():
                yield f"{package}/{path.relative_to(root).as_posix()}", path


def compare_file(label: str, path: Path) -> Record:
    """Read one file with each reader.

    Returns:
        `result`: `read` or the reason of our refusal; `peers`: by name, AGREES, the difference, or
        the reason of a refusal; `unexplained`: names of peers that differ from us without an
        explanation; `seconds`: CPU seconds by reader.
    """
    began = process_time()
    own = measured(fgenv, path)
    seconds = {"fgenv": process_time() - began}
    file = None if isinstance(own, str) else read_mesh_file(path)
    unit = 1.0 if file is None or file.unit is None else file.unit.meters
    peers: dict[str, str] = {}
    for name, read in PEERS.items():
        began = process_time()
        other = measured(read, path)
        seconds[name] = process_time() - began
        peers[name] = verdict_of(own, other, unit)
    return {
        "file": label,
        "format": path.suffix.lower().removeprefix("."),
        "result": own if isinstance(own, str) else "read",
        "peers": peers,
        "unexplained": [
            name
            for name, verdict in peers.items()
            if verdict != AGREES and not explanation(label, name, peers, file)
        ],
        "seconds": seconds,
    }


def verdict_of(own: Measures | str, other: Measures | str, unit: float) -> str:
    """Return AGREES, UNIT, `refuses: ...`, READS (a file that we refuse), or the difference."""
    if isinstance(other, str):
        return f"{REFUSES}: {other}"
    if isinstance(own, str):
        return READS
    difference = own.difference(other)
    if not difference:
        return AGREES
    return UNIT if unit != 1.0 and not own.difference(other.scaled(unit)) else difference


def bench_meshes(quick: bool, progress: Any) -> Iterator[Record]:
    """Yield a row per format and, with `unexplained`, the files that need an explanation."""
    files = files_with(READERS)
    files = files[:: max(1, len(files) // 100)] if quick else files
    rows = []
    for k, (label, path) in enumerate(files):
        progress(f"{k} of {len(files)} files: {label}")
        rows.append(compare_file(label, path))
    for kind in sorted({row["format"] for row in rows}):
        yield summary(kind, [row for row in rows if row["format"] == kind])


def summary(kind: str, rows: Sequence[Record]) -> Record:
    """Return the counts of one format."""
    peers = {name: Counter(map(partial(_short, name), rows)) for name in PEERS}
    seconds = {name: sum(row["seconds"][name] for row in rows) for name in ("fgenv", *PEERS)}
    return {
        "format": kind,
        "files": len(rows),
        "read": sum(row["result"] == "read" for row in rows),
        "refused": [f"{row['file']}: {row['result']}" for row in rows if row["result"] != "read"],
        "peers": {name: dict(counts) for name, counts in peers.items()},
        "confirmed": sum(CONFIRMING & set(row["peers"].values()) != set() for row in rows),
        "unexplained": list(unexplained(rows)),
        "seconds": seconds,
    }


def _short(name: str, row: Record) -> str:
    """A verdict without its reason."""
    verdict: str = row["peers"][name]
    return verdict.partition(":")[0]


def unexplained(rows: Iterable[Record]) -> Iterator[str]:
    """Yield file, peer and verdict of each difference without an explanation."""
    for row in rows:
        for name in row["unexplained"]:
            yield f"{row['file']}: {name}: {row['peers'][name]}"
