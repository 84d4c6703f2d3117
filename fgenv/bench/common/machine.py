"""The machine and the libraries of a measurement."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterable
from importlib.metadata import version
from typing import Any

import numpy as np


def machine() -> dict[str, Any]:
    """Return processor, cores, system and versions of Python and NumPy."""
    return {
        "processor": _processor(),
        "cores": os.cpu_count(),
        "system": f"{platform.system()} {platform.machine()}",
        "python": platform.python_version(),
        "numpy": np.__version__,
    }


def _processor() -> str:
    try:
        with open("/proc/cpuinfo", encoding="utf-8") as lines:
            return next(line.split(":", 1)[1].strip() for line in lines if "model name" in line)
    except (OSError, StopIteration):
        return platform.processor() or "unknown"


def package_versions(names: Iterable[str]) -> dict[str, str]:
    """Return the installed versions of packages.

    Raises:
        PackageNotFoundError: an ImportError with the name of a package that is not installed.
    """
    return {name: version(name) for name in names}
