"""A viser server on exactly the requested port, for this machine alone unless it has a token."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from .access import Access, restricted

if TYPE_CHECKING:
    import viser

HOST = "127.0.0.1"
PORT = 8080
REMEDY = "pip install 'fgenv[view]'"


def viser_module() -> Any:
    """Return viser, or raise ImportError with the remedy."""
    try:
        import viser
    except ImportError:
        raise ImportError(f"the browser view needs viser; remedy: {REMEDY}") from None
    return viser


def serve(
    port: int = PORT, label: str = "fgenv", host: str = HOST, token: str = ""
) -> viser.ViserServer:
    """Start a server in threads of its own.

    Args:
        port: 0: any free port, which `get_port` returns.
        host: address of the network interface.
        token: required of browsers; empty: only names of this machine are accepted.

    Raises:
        ValueError: an invalid port, or one in use.
        ImportError: viser is missing, with the remedy.
    """
    if isinstance(port, bool) or not isinstance(port, int) or not 0 <= port < 65536:
        raise ValueError(f"port: got {port!r}, expected 0 to 65535")
    module = viser_module()
    with quiet(), restricted(Access(token)):
        server: viser.ViserServer = module.ViserServer(host, port, label, verbose=False)
        if port not in (0, server.get_port()):  # viser uses the next free port
            server.stop()
            raise ValueError(f"port: {port} is taken; choose another one, or 0 for any")
    return server


@contextmanager
def serving(port: int = PORT, label: str = "fgenv") -> Iterator[viser.ViserServer]:
    """Run a server within a context."""
    server = serve(port, label)
    try:
        yield server
    finally:
        stop(server)


def stop(server: viser.ViserServer) -> None:
    """Stop a server without output."""
    with quiet():
        server.stop()


@contextmanager
def quiet() -> Iterator[None]:
    """Suppress viser's messages: stdout can carry JSON."""
    with contextlib.redirect_stdout(io.StringIO()):
        yield
