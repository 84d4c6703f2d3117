"""A viser server: on the port that was asked for and no other, for this machine alone."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import viser

HOST = "127.0.0.1"
PORT = 8080
REMEDY = "pip install 'fgenv[view]'"


def viser_module() -> Any:
    """viser, or ImportError with the remedy."""
    try:
        import viser
    except ImportError:
        raise ImportError(f"the browser view wants viser; remedy: {REMEDY}") from None
    return viser


def serve(port: int = PORT, label: str = "fgenv", host: str = HOST) -> viser.ViserServer:
    """A server, in threads of its own.

    Args:
        port: 0: any that is free; `get_port` tells.

    Raises:
        ValueError: no such port, or somebody else has it.
        ImportError: viser is missing, with the remedy.
    """
    if isinstance(port, bool) or not isinstance(port, int) or not 0 <= port < 65536:
        raise ValueError(f"port: got {port!r}, expected 0 to 65535")
    module = viser_module()
    with quiet():
        server: viser.ViserServer = module.ViserServer(host, port, label, verbose=False)
        if port not in (0, server.get_port()):  # viser went on to the next one
            server.stop()
            raise ValueError(f"port: {port} is taken; choose another one, or 0 for any")
    return server


@contextmanager
def serving(port: int = PORT, label: str = "fgenv") -> Iterator[viser.ViserServer]:
    """A server that is stopped in the end."""
    server = serve(port, label)
    try:
        yield server
    finally:
        stop(server)


def stop(server: viser.ViserServer) -> None:
    """Stop it, without a word."""
    with quiet():
        server.stop()


@contextmanager
def quiet() -> Iterator[None]:
    """viser tells of its server on stdout, which may be for a machine."""
    with contextlib.redirect_stdout(io.StringIO()):
        yield
