"""Files with arrays from others: sizes are checked before a byte is inflated."""

from __future__ import annotations

import io
import struct
import tracemalloc
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fgenv.agents import run_episode
from fgenv.agents.policies.policy_file import PolicyError, PolicyFile
from fgenv.agents.weights import included
from fgenv.envs import Record, Simulator, policy_of
from fgenv.envs.record import RECORD, RecordError
from fgenv.npz import NpzError, open_npz
from fgenv.planners.plan import Plan, PlanError
from fgenv.scenarios.errors import ScenarioError
from fgenv.scenarios.frozen_set import frozen
from fgenv.view.episodes import load_episode

LOADERS: list[tuple[Callable[[Path], Any], type[Exception]]] = [
    (Record.load, RecordError),
    (Plan.load, PlanError),
    (PolicyFile.load, PolicyError),
    (frozen, ScenarioError),
    (load_episode, RecordError),
]


@pytest.fixture(scope="module")
def record() -> Record:
    simulator = Simulator("swap", n=2, autoreset=False)
    return run_episode(simulator, policy_of("goto"), steps=5)


def header(shape: tuple[int, ...], dtype: str = "<f8") -> bytes:
    """Header of an array in NumPy's format 1.0."""
    file = io.BytesIO()
    about = {"descr": dtype, "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(file, about)
    return file.getvalue()


def text(value: str) -> bytes:
    return header((), f"<U{len(value)}") + value.encode("utf-32-le")


def write(path: Path, entries: dict[str, bytes], method: int = zipfile.ZIP_DEFLATED) -> None:
    with zipfile.ZipFile(path, "w", method) as file:
        for name, content in entries.items():
            file.writestr(f"{name}.npy", content)


def write_bomb(path: Path, entries: dict[str, bytes], name: str, gib: int) -> None:
    """Add an array of zeros to a file, 1 GiB in 5 MB."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as file:
        for other, content in entries.items():
            file.writestr(f"{other}.npy", content)
        with file.open(f"{name}.npy", "w", force_zip64=True) as entry:
            entry.write(header((gib << 27,)))
            block = bytes(1 << 24)
            for _ in range(gib << 6):
                entry.write(block)


@pytest.fixture(scope="module")
def bomb(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("bomb") / "bomb.npz"
    about = {"format": text("fgenv record 1"), "id": text("0"), "scenario": text("{}")}
    write_bomb(path, {**about, "about": text("{}")}, "configurations", 1)
    assert path.stat().st_size < 8_000_000
    return path


@pytest.mark.parametrize(("load", "error"), LOADERS)
def test_a_bomb_is_refused_without_inflating_it(
    bomb: Path, load: Callable[[Path], Any], error: type[Exception]
) -> None:
    tracemalloc.start()
    try:
        with pytest.raises(error):
            load(bomb)
        assert tracemalloc.get_traced_memory()[1] < 20_000_000
    finally:
        tracemalloc.stop()


def test_a_record_with_more_than_its_scenario_allows_is_refused(
    record: Record, tmp_path: Path
) -> None:
    path, texts = tmp_path / "a.npz", record.texts
    wide = np.zeros((len(record) + 1, record.n_robots, 100_000))  # 10 MB of zeros
    RECORD.save(path, texts, {**record.arrays, "configurations": wide})
    with pytest.raises(RecordError, match=r"configurations: got float64 .*100000"):
        Record.load(path)
    RECORD.save(path, texts, {**record.arrays, "more": np.zeros(3)})
    with pytest.raises(RecordError, match="arrays"):
        Record.load(path)
    record.save(path)
    assert Record.load(path).id == record.id


VALID = {"format": text("fgenv record 1"), "a": header((2,)) + bytes(16)}
INVALID: dict[str, dict[str, bytes]] = {
    "a header that claims more": {"a": header((1 << 40,)) + bytes(16)},
    "a header that claims less": {"a": header((1,)) + bytes(16)},
    "an overflow of 64 bits": {"a": header((1 << 32, 1 << 32)) + bytes(16)},
    "objects": {"a": header((2,), "|O") + bytes(16)},
    "no header": {"a": b"hello"},
    "nothing": {"a": b""},
    "version 2": {"a": b"\x93NUMPY\x02\x00" + struct.pack("<I", 1 << 31) + b"{}"},
    "code in the header": {
        "a": b"\x93NUMPY\x01\x00" + struct.pack("<H", 20) + b"__import__('os')".ljust(20)
    },
    "another name": {"../a.txt": b"text"},
    "700 MB in 700 arrays": {f"a{k}": header((1 << 17,)) for k in range(700)},
}


@pytest.mark.parametrize("entries", INVALID.values(), ids=INVALID)
def test_each_fault_is_refused(tmp_path: Path, entries: dict[str, bytes]) -> None:
    path = tmp_path / "a.npz"
    write(path, VALID)
    with open_npz(path) as file:
        assert file.read("a").tolist() == [0.0, 0.0]
    write(path, {**VALID, **entries})
    with open_npz(path) as file, pytest.raises(ValueError):  # noqa: PT011 (NumPy's own messages)
        _ = file.headers
    for load, error in LOADERS:
        with pytest.raises(error):
            load(path)


def test_other_compressions_and_comments_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.npz"
    for method in (zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA):
        write(path, VALID, method)
        with open_npz(path) as file, pytest.raises(NpzError, match="compression"):
            _ = file.headers
    write(path, VALID)
    with zipfile.ZipFile(path, "a") as archive:
        archive.comment = b"PK"
    with pytest.raises(NpzError, match="table"), open_npz(path):
        pass


@given(data=st.data())
def test_a_damaged_record_is_refused_or_equal(
    record: Record, tmp_path_factory: pytest.TempPathFactory, data: st.DataObject
) -> None:
    path = tmp_path_factory.getbasetemp() / "damaged.npz"
    record.save(path)
    content = bytearray(path.read_bytes())
    kind = data.draw(st.sampled_from(["flip", "cut", "insert"]))
    k = data.draw(st.integers(0, len(content) - 1))
    if kind == "flip":
        content[k] ^= 1 << data.draw(st.integers(0, 7))
    elif kind == "cut":
        del content[k : k + data.draw(st.integers(1, 5000))]
    else:
        content[k:k] = data.draw(st.binary(min_size=1, max_size=50))
    path.write_bytes(content)
    try:
        assert Record.load(path).id == record.id  # a byte that nothing uses, such as a date
    except RecordError as error:
        assert len(str(error)) < 500  # noqa: PT017


def test_included_policies_are_within_the_bounds() -> None:
    for name, path in included().items():
        assert PolicyFile.load(path), name
