"""What a user sees of an error: one line on stderr and an exit code, never a traceback."""

import os
import sys
from typing import Any

FAILED_CHECK = 1  # the command ran and what it checks does not hold
BAD_INPUT = 2  # wrong use: an argument, a file, a missing extra
OUR_MISTAKE = 3  # an error nobody foresaw
INTERRUPTED = 130  # Ctrl-C, as shells count it

# Modules that an extra brings, by the name that ImportError gives.
EXTRA_OF = {
    "coal": "bench",
    "embreex": "bench",
    "example_robot_data": "bench",
    "fcl": "bench",
    "gymnasium_robotics": "bench",
    "hppfcl": "bench",
    "imageio_ffmpeg": "view",
    "matplotlib": "view",
    "mpe2": "bench",
    "mujoco": "bench",
    "pybullet": "bench",
    "pybullet_data": "bench",
    "rtbdata": "bench",
    "igl": "dev",
    "scipy": "bench",
    "stable_baselines3": "agents",
    "supersuit": "bench",
    "torch": "agents",
    "viser": "view",
    "vmas": "bench",
}


def report(error: Exception) -> int:
    """Print `error` as one line on stderr and return the exit code that it stands for.

    With FGENV_DEBUG=1 in the environment the error is raised again, traceback and all.
    """
    if os.environ.get("FGENV_DEBUG") == "1":
        raise error
    print(f"fgenv: {_one_line(describe(error))}", file=sys.stderr)
    return exit_code(error)


def exit_code(error: Exception) -> int:
    """BAD_INPUT for what a user can put right, else OUR_MISTAKE."""
    if _is_wrong_use(error):
        return BAD_INPUT
    if isinstance(error, ImportError):
        return BAD_INPUT if _extra(error) or _tells_remedy(error) else OUR_MISTAKE
    return BAD_INPUT if isinstance(error, ValueError | TypeError | OSError) else OUR_MISTAKE


def describe(error: Exception) -> str:
    """The message for `error`, with the remedy where there is one."""
    if _is_wrong_use(error):
        return _wrong_use(error)
    if isinstance(error, ImportError) and _tells_remedy(error):
        return str(error)
    if isinstance(error, ImportError) and (extra := _extra(error)):
        return f"{_module(error)} is not installed; remedy: pip install 'fgenv[{extra}]'"
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    if exit_code(error) == OUR_MISTAKE:
        return f"{type(error).__name__}: {error} (unforeseen; FGENV_DEBUG=1 shows where)"
    return str(error) or type(error).__name__


def _is_wrong_use(error: Exception) -> bool:
    """Whether the command line parser found it: an option, an argument, a command."""
    return hasattr(error, "format_message")


def _wrong_use(error: Any) -> str:
    context = getattr(error, "ctx", None)
    command = context.command_path if context else "fgenv"
    return f"{error.format_message().rstrip('.')} (see {command} --help)"


def _extra(error: ImportError) -> str | None:
    return EXTRA_OF.get(_module(error).partition(".")[0])


def _module(error: ImportError) -> str:
    """What could not be imported; trimesh raises such errors later, without their name."""
    return error.name or str(error).removeprefix("No module named ").strip("'")


def _tells_remedy(error: ImportError) -> bool:
    return "pip install" in str(error)


def _one_line(text: str) -> str:
    return " ".join(text.split())
