"""Access to a live view: the requests that its server accepts.

Any page that a browser has open can connect to a server on this machine, directly or with a host
name that resolves to 127.0.0.1. Without `--host` the server therefore accepts the names of this
machine only, and web sockets of its own page only. With `--host` other machines can connect; each
browser needs the token of the address, and keeps it in a cookie.
"""

from __future__ import annotations

import hmac
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from http import HTTPStatus
from http.cookies import CookieError, SimpleCookie
from typing import TYPE_CHECKING, Any
from urllib.parse import parse_qs, urlsplit

if TYPE_CHECKING:
    from websockets.asyncio.server import ServerConnection
    from websockets.datastructures import Headers
    from websockets.http11 import Request, Response

    Handler = Callable[[ServerConnection, Request], Response | None]

LOCAL_NAMES = ("localhost", "127.0.0.1", "::1")
REALM = "fgenv"
_lock = threading.Lock()


@dataclass(frozen=True)
class Access:
    """Rules of a server; `token` is empty for a server of this machine alone."""

    token: str = ""

    def refusal(self, headers: Headers, path: str, port: int) -> str | None:
        """Return the reason to refuse a request, or None."""
        hosts, origins = headers.get_all("Host"), headers.get_all("Origin")
        if len(hosts) != 1 or len(origins) > 1:
            return "expected one Host and at most one Origin"
        host = hosts[0].lower()
        if not self.token and address(host) not in [(name, port) for name in LOCAL_NAMES]:
            return "this view accepts names of its own machine only; use localhost or --host"
        if origins and origins[0].lower() not in (f"http://{host}", f"https://{host}"):
            return "this view accepts connections of its own page only"
        if self.token and not (self._in_query(path) or self._in_cookie(headers, port)):
            return "this view needs the token of its address; open the address that it printed"
        return None

    def cookie(self, path: str, port: int) -> str | None:
        """Return the cookie to set for an address with the token, or None."""
        if not (self.token and self._in_query(path)):
            return None
        return f"{REALM}-{port}={self.token}; Path=/; HttpOnly; SameSite=Strict"

    def _in_query(self, path: str) -> bool:
        values = parse_qs(urlsplit(path).query, max_num_fields=20).get("token", [])
        return any(self._equal(value) for value in values)

    def _in_cookie(self, headers: Headers, port: int) -> bool:
        for text in headers.get_all("Cookie"):
            try:
                cookie = SimpleCookie(text).get(f"{REALM}-{port}")
            except CookieError:
                continue
            if cookie is not None and self._equal(cookie.value):
                return True
        return False

    def _equal(self, value: str) -> bool:
        return hmac.compare_digest(value.encode(), self.token.encode())


def address(host: str) -> tuple[str, int] | None:
    """Return name and port of a Host header (default: 80), or None for an invalid one."""
    try:
        parts = urlsplit(f"//{host}")
        valid = parts.netloc == host and "@" not in host and parts.hostname
        return (parts.hostname or "", parts.port or 80) if valid else None
    except ValueError:
        return None


@contextmanager
def restricted(access: Access) -> Iterator[None]:
    """Apply rules to the viser servers that start within a context.

    viser has no hook for requests, but calls `serve` of websockets as it starts; each request then
    passes the rules before viser's own handler. Other servers are left alone.
    """
    from websockets.asyncio import server as module

    original: Any = module.serve

    def serve(handler: Any, *args: Any, **options: Any) -> Any:
        if str(getattr(handler, "__module__", "")).startswith("viser."):
            options["process_request"] = guarded(access, options["process_request"])
        return original(handler, *args, **options)

    with _lock:
        module.serve = serve  # type: ignore[assignment, misc]
        try:
            yield
        finally:
            module.serve = original  # type: ignore[misc]


def guarded(access: Access, handler: Handler) -> Handler:
    """Return a handler of requests that applies rules before another one."""

    def process(connection: ServerConnection, request: Request) -> Response | None:
        port = int(connection.local_address[1])
        try:
            reason = access.refusal(request.headers, request.path, port)
            cookie = None if reason else access.cookie(request.path, port)
        except ValueError:
            reason, cookie = "invalid request", None
        if reason:
            return connection.respond(HTTPStatus.FORBIDDEN, f"{reason}\n")
        response = handler(connection, request)
        if response is not None:
            response.headers["Referrer-Policy"] = "no-referrer"
            response.headers["X-Frame-Options"] = "DENY"
            if cookie:
                response.headers["Set-Cookie"] = cookie
        return response

    return process
