"""Archives: the id is the documented hash; files of other programs raise an error."""

from __future__ import annotations

import hashlib
import struct
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fgenv.archive import Archive


class OddError(ValueError):
    """Error of the archives in this module."""


ODD = Archive("odd", 2, ("about",), OddError, "make it again", dtypes={"marks": "<i4"})
TEXTS = {"about": "äh"}
ARRAYS = {"marks": np.array([7, -1], ">i4"), "places": np.array([[0.5], [2.0]], np.float32)}


def test_the_id_is_the_hash_of_the_bytes_that_the_format_tells(tmp_path: Path) -> None:
    said = b"fgenv odd 2\n" + "about 2\näh\n".encode()
    said += b"marks (2,)\n" + struct.pack("<2i", 7, -1)
    said += b"places (2, 1)\n" + struct.pack("<2d", 0.5, 2.0)
    expected = hashlib.sha256(said).hexdigest()
    assert ODD.id(TEXTS, ARRAYS) == expected
    ODD.save(tmp_path / "a.npz", TEXTS, ARRAYS)
    with np.load(tmp_path / "a.npz") as file:
        assert str(file["id"]) == expected
        assert [file[name].dtype.str for name in ARRAYS] == ["<i4", "<f8"]
    texts, arrays = ODD.load(tmp_path / "a.npz", lambda *found: found)
    assert texts == TEXTS
    assert all(np.array_equal(arrays[name], array) for name, array in ARRAYS.items())


def test_an_interrupted_save_leaves_what_was_there(tmp_path: Path) -> None:
    class Interrupting:
        def __array__(self, dtype: object = None, copy: object = None) -> np.ndarray:
            self.asked = getattr(self, "asked", 0) + 1
            if self.asked > 1:  # the hash was made, the file is begun
                raise KeyboardInterrupt
            return np.zeros(3)

    ODD.save(tmp_path / "a.npz", TEXTS, ARRAYS)
    before = (tmp_path / "a.npz").read_bytes()
    with pytest.raises(KeyboardInterrupt):
        ODD.save(tmp_path / "a.npz", TEXTS, {"late": Interrupting()})  # type: ignore[dict-item]
    assert (tmp_path / "a.npz").read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["a.npz"]


def test_another_version_is_told_whatever_is_in_it(tmp_path: Path) -> None:
    new: dict[str, Any] = {
        "format": "fgenv odd 3",
        "id": "0",
        "places": np.array([{}], dtype=object),
    }
    np.savez(tmp_path / "new.npz", **new)  # an array that this version cannot read
    with pytest.raises(
        OddError,
        match="got 'fgenv odd 3', expected 'fgenv odd 2'; use the fgenv that wrote it, or make it",
    ):
        ODD.load(tmp_path / "new.npz", lambda *found: found)


@pytest.mark.parametrize(
    "change",
    [
        {"places": np.array([[0.5], [2.5]])},
        {"places": np.array([[0.5, 2.0]])},
        {"about": "oh"},
        {"more": np.zeros(1)},
        {"format": "fgenv even 2"},
        {"marks": np.array(["7", "x"])},
    ],
)
def test_nothing_is_changed_unnoticed(change: dict[str, Any], tmp_path: Path) -> None:
    ODD.save(tmp_path / "a.npz", TEXTS, ARRAYS)
    with np.load(tmp_path / "a.npz") as file:
        content = dict(file)
    np.savez(tmp_path / "b.npz", **{**content, **change})
    with pytest.raises(OddError, match=r"b\.npz: is damaged, or no odd; make it again"):
        ODD.load(tmp_path / "b.npz", lambda *found: found)


def test_what_cannot_be_read_is_damaged_and_own_errors_stay(tmp_path: Path) -> None:
    ODD.save(tmp_path / "a.npz", TEXTS, ARRAYS)
    with pytest.raises(OddError, match="is damaged"):
        ODD.load(tmp_path / "a.npz", lambda texts, arrays: arrays["missing"])

    def refuse(texts: object, arrays: object) -> None:
        raise OddError("marks do not fit")

    with pytest.raises(OddError, match=r"a\.npz: marks do not fit$"):
        ODD.load(tmp_path / "a.npz", refuse)
