"""A corpus of hostile files for all readers, read one by one within bounds of memory and time.

Run as a module, it reads the corpus: each file in 10 s of processor time, all in 2 GB of memory.
"""

from __future__ import annotations

import re
import resource
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from zlib import crc32

import numpy as np

from support.small_files import SmallFile, small_files

MAX_SECONDS = 10
MAX_BYTES = 2 << 30
NUMBER = re.compile(rb"(?<![\w.])-?\d+(?:\.\d+)?(?![\w.])")
NUMBERS = (b"1e308", b"-1", b"nan", b"99999999999", b"1e-320")
REPEATED = 8_000  # lines
DEPTH = 50_000


def hostile_files() -> Iterator[tuple[str, SmallFile, bytes]]:
    """What is wrong, a small file, and the content in its place."""
    for file in small_files():
        if file.content.isascii():
            yield from ((what, file, content) for what, content in _of_text(file))
        else:
            yield "ones", file, file.content[:20] + b"\xff" * (len(file.content) - 20)
            yield "zeros", file, file.content[:20] + bytes(1 << 20)


def _of_text(file: SmallFile) -> Iterator[tuple[str, bytes]]:
    """Numbers that are too large, too small or none; long lines, deep nesting, many equal lines."""
    rng = np.random.default_rng(crc32(file.name.encode()))
    places = [match.span() for match in NUMBER.finditer(file.content)]
    for number in NUMBERS if places else ():
        begin, end = places[int(rng.integers(len(places)))]
        yield f"{number!r}", file.content[:begin] + number + file.content[end:]
        yield f"all {number!r}", NUMBER.sub(number, file.content)
    lines = file.content.splitlines(keepends=True)
    middle = len(lines) // 2
    line = lines[middle]
    yield "many lines", b"".join([*lines[:middle], line * REPEATED, *lines[middle:]])
    yield "a long line", b"".join([*lines[:middle], line.rstrip() * REPEATED, *lines[middle:]])
    yield "brackets", b"".join([*lines[:middle], b"[" * DEPTH, *lines[middle:]])


def read_all() -> int:
    """Read the corpus; return the number of files."""
    size = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (size + MAX_BYTES, size + MAX_BYTES))
    count = 0
    for what, file, content in hostile_files():
        print(file.name, what, flush=True)  # the last one printed is at fault
        used = resource.getrusage(resource.RUSAGE_SELF)
        limit = int(used.ru_utime + used.ru_stime) + MAX_SECONDS + 1
        resource.setrlimit(resource.RLIMIT_CPU, (limit, resource.RLIM_INFINITY))
        with tempfile.TemporaryDirectory() as folder:
            file.outcome(file.write(Path(folder), content))
        count += 1
    return count


if __name__ == "__main__":
    sys.exit(0 if read_all() >= 200 else "under 200 files")
