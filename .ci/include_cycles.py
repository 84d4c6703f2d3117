"""Fails on an include cycle in fgenv/native, or on an include against the layers of its folders."""

import re
import sys
from pathlib import Path

NATIVE = Path(__file__).parent.parent / "fgenv" / "native"
ALLOWED = {  # folder: the folders that it may include
    "math": "math",
    "shape": "shape math",
    "query": "query shape math",
    "motion": "motion query shape math",
    "robot": "robot motion query shape math",
    "world": "world robot motion query shape math",
    "policy": "policy query shape math",
    "render": "render query shape math",
    "simulator": "simulator policy world robot motion query shape math",
    "bind": "bind render simulator policy world robot motion query shape math",
}
includes = {
    str(path.relative_to(NATIVE)): re.findall(r'^#include "(.+)"', path.read_text(), re.M)
    for path in NATIVE.rglob("*.[hc]*")
}
errors = [
    f"{path}: includes {name}, which is in no layer below"
    for path, names in includes.items()
    for name in names
    if Path(name).parts[0] not in ALLOWED[Path(path).parts[0]].split()
]
while leaves := [path for path, names in includes.items() if not set(names) & includes.keys()]:
    for path in leaves:
        del includes[path]
errors += [f"{path}: part of an include cycle, or includes one" for path in includes]
sys.exit("\n".join(errors) if errors else 0)
