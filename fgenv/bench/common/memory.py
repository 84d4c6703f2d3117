"""Bytes that a library keeps for a model, asked of the C allocator."""

from __future__ import annotations

import ctypes
import gc
from collections.abc import Callable
from typing import Any


class _Mallinfo(ctypes.Structure):
    # struct mallinfo2 of glibc 2.33 and later
    _fields_ = [
        (name, ctypes.c_size_t)
        for name in ("arena", "ordblks", "smblks", "hblks", "hblkhd")
        + ("usmblks", "fsmblks", "uordblks", "fordblks", "keepcost")
    ]


def allocated() -> int | None:
    """Bytes in use by malloc in this process; None if the C library does not report them."""
    try:
        ask = ctypes.CDLL(None).mallinfo2
    except AttributeError:
        return None
    ask.restype = _Mallinfo
    info = ask()
    return int(info.uordblks + info.hblkhd)


def kept_bytes(build: Callable[[], Any]) -> int | None:
    """Bytes held by the model that `build` makes; None if unknown."""
    gc.collect()
    before = allocated()
    model = build()
    gc.collect()
    after = allocated()
    del model
    return None if before is None or after is None else after - before
