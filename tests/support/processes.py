"""Waiting for the CPU time of a process, independent of the machine's load."""

from __future__ import annotations

import os
import subprocess
import time
from pathlib import Path


def wait_for_cpu(process: subprocess.Popen[bytes], seconds: float) -> None:
    """Wait until a process has used the given CPU-seconds, or has ended."""
    while process.poll() is None:
        fields = Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
        ticks = int(fields[11]) + int(fields[12])  # user and system time
        if ticks / os.sysconf("SC_CLK_TCK") >= seconds:
            return
        time.sleep(0.05)
