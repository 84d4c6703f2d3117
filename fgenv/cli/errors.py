"""Errors of the command line: one line on stderr and an exit code, without a traceback."""

import os
import sys
from typing import Any, NoReturn

import typer

FAILED_CHECK = 1  # the command ran, and its check failed
BAD_INPUT = 2  # invalid argument or file, missing extra
OUR_MISTAKE = 3  # an unexpected error
INTERRUPTED = 130  # Ctrl-C, by the convention of shells

# Extra that installs a module, by the module name of an ImportError.
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
    "mujoco": "mjcf",
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
    """Print an error as one line on stderr and return its exit code.

    With FGENV_DEBUG=1 in the environment the error is raised again, with its traceback.
    """
    if os.environ.get("FGENV_DEBUG") == "1":
        raise error
    print(f"fgenv: {_one_line(describe(error))}", file=sys.stderr)
    return exit_code(error)


def fail_check(error: Exception) -> NoReturn:
    """Print an error as one line on stderr and end with FAILED_CHECK.

    Raises:
        typer.Exit: always; with FGENV_DEBUG=1 the error itself.
    """
    if os.environ.get("FGENV_DEBUG") == "1":
        raise error
    print(f"fgenv: {_one_line(str(error))}", file=sys.stderr)
    raise typer.Exit(FAILED_CHECK)


def exit_code(error: Exception) -> int:
    """Return BAD_INPUT for errors that a user can correct, else OUR_MISTAKE."""
    if _is_wrong_use(error):
        return BAD_INPUT
    if isinstance(error, ImportError):
        return BAD_INPUT if _extra(error) or _has_remedy(error) else OUR_MISTAKE
    return BAD_INPUT if isinstance(error, ValueError | TypeError | OSError) else OUR_MISTAKE


def describe(error: Exception) -> str:
    """Return the message of an error, with the remedy if there is one."""
    if _is_wrong_use(error):
        return _wrong_use(error)
    if isinstance(error, ImportError) and _has_remedy(error):
        return str(error)
    if isinstance(error, ImportError) and (extra := _extra(error)):
        return f"{_module(error)} is not installed; remedy: pip install 'fgenv[{extra}]'"
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    if exit_code(error) == OUR_MISTAKE:
        return f"{type(error).__name__}: {error} (unforeseen; FGENV_DEBUG=1 shows where)"
    return _with_option(str(error)) or type(error).__name__


def _with_option(message: str) -> str:
    """Return a message about an argument with the name of its option, if that was given."""
    name, colon, rest = message.partition(":")
    option = "--" + name.replace("_", "-")
    given = any(word.partition("=")[0] == option for word in sys.argv[1:])
    return f"{option}{colon}{rest}" if given else message


def _is_wrong_use(error: Exception) -> bool:
    """Return whether the command line parser raised an error."""
    return hasattr(error, "format_message")


def _wrong_use(error: Any) -> str:
    context = getattr(error, "ctx", None)
    command = context.command_path if context else "fgenv"
    return f"{error.format_message().rstrip('.')} (see {command} --help)"


def _extra(error: ImportError) -> str | None:
    return EXTRA_OF.get(_module(error).partition(".")[0])


def _module(error: ImportError) -> str:
    """Return the missing module; trimesh re-raises such errors without the name."""
    return error.name or str(error).removeprefix("No module named ").strip("'")


def _has_remedy(error: ImportError) -> bool:
    return "pip install" in str(error)


def _one_line(text: str) -> str:
    return " ".join(text.split())
