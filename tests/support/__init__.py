"""Helpers for tests."""

import os
from pathlib import Path

TESTS = Path(__file__).parent.parent
ROOT = TESTS.parent
CASES = int(os.environ.get("FGENV_CASES", "1"))  # factor of long runs; 10 in .ci/nightly
