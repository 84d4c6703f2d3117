"""Expansion of xacro files, in a process of its own with bounds of time and memory.

Run as a module, it is that process: a request as JSON on stdin, the URDF text on stdout.
"""

from __future__ import annotations

import json
import re
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from .mesh_location import PackagePaths, find_package

MAX_SECONDS = 60
MAX_MEMORY = 4 << 30  # bytes
MAX_BYTES = 64_000_000  # of the expanded text


def expand_xacro(path: Path, arguments: Mapping[str, str], packages: PackagePaths) -> bytes:
    """The URDF text of a xacro file.

    Args:
        arguments: values of `<xacro:arg>` by name.
        packages: folders in which `$(find NAME)` searches first.

    Raises:
        ModuleNotFoundError: xacro is not installed.
        FileNotFoundError: no such file.
        ValueError: a fault in the file, an argument that it does not have, or too large a result.
    """
    if not path.is_file():
        raise FileNotFoundError(f"path: {path} is no file, expected a xacro file")
    request = {
        "path": str(path),
        "arguments": {name: str(value) for name, value in arguments.items()},
        "folders": [str(folder) for folder in packages.folders],
        "packages": {name: str(folder) for name, folder in packages.packages.items()},
    }
    command = [sys.executable, "-m", __name__]
    try:
        done = subprocess.run(
            command, input=json.dumps(request).encode(), capture_output=True, timeout=MAX_SECONDS
        )
    except subprocess.TimeoutExpired:
        raise ValueError(
            f"path: {path} was not expanded in {MAX_SECONDS} s; expected a xacro file that ends"
        ) from None
    if done.returncode == 3:
        raise ModuleNotFoundError(
            "to read xacro, xacro is needed; remedy: pip install 'fgenv[urdf]'", name="xacro"
        )
    if done.returncode:
        lines = done.stderr.decode(errors="replace").strip().splitlines() or ["it was stopped"]
        fault = re.sub(r"^<class '\w+'>: ", "", lines[-1])  # of an exception that xacro wraps
        raise ValueError(f"path: {path}: {fault}; expected a xacro file that expands")
    return done.stdout


class _Arguments(dict[str, str]):
    """Arguments that keep the names which were asked for."""

    def __init__(self, values: Mapping[str, str]) -> None:
        super().__init__(values)
        self.asked: set[object] = set()

    def __contains__(self, name: object) -> bool:
        self.asked.add(name)
        return super().__contains__(name)

    def __getitem__(self, name: str) -> str:
        self.asked.add(name)
        return super().__getitem__(name)


def _expanded(request: Mapping[str, Any]) -> str:
    """The text for a request of `expand_xacro`."""
    import xacro
    from xacro import substitution_args

    folders = tuple(Path(folder) for folder in request["folders"])
    paths = PackagePaths(folders, {k: Path(v) for k, v in request["packages"].items()})
    source = Path(request["path"])

    def find(package: str) -> str:
        return str(find_package(package, source, paths))

    substitution_args._eval_find = substitution_args._eval_dict["find"] = find
    arguments = _Arguments(request["arguments"])
    text: str = xacro.process_file(request["path"], mappings=arguments).toxml()
    unknown = [name for name in request["arguments"] if name not in arguments.asked]
    if unknown:
        raise ValueError(f"no argument {unknown[0]!r}; remove it from xacro_args")
    if len(text) > MAX_BYTES:
        raise ValueError(f"over {MAX_BYTES:,} characters of URDF")
    return text


def _limit_memory() -> None:
    try:
        import resource
    except ModuleNotFoundError:  # not on every system
        return
    resource.setrlimit(resource.RLIMIT_AS, (MAX_MEMORY, MAX_MEMORY))


def _main() -> None:
    """Answer one request."""
    request = json.load(sys.stdin)
    _limit_memory()
    try:
        text = _expanded(request)
    except ModuleNotFoundError as error:
        if error.name == "xacro":
            sys.exit(3)
        raise
    except (Exception, RecursionError) as error:  # xacro raises whatever its expressions raise
        inner: object = error
        while getattr(inner, "exc", None) is not None:
            inner = inner.exc  # type: ignore[attr-defined]
        name = "" if str(inner) else f"{type(inner).__name__} "
        sys.exit(name + " ".join(str(error).split()))
    sys.stdout.buffer.write(text.encode())


if __name__ == "__main__":
    _main()
