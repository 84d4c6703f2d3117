"""Security of replay pages: data cannot become script, and a policy allows no other script."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from typing import Any

SCRIPT = re.compile(r'<script(?:\s+[\w-]+(?:="[^"]*")?)*\s*>(.*?)</script>', re.DOTALL)
FIRST = '<meta charset="utf-8" />'  # of viser's page
DIRECTIVES = (
    "default-src 'none'",
    # The page's own scripts by their hashes. They insert viser's client, hence strict-dynamic; its
    # WebAssembly (embind) makes functions of text, hence unsafe-eval. Neither admits markup.
    "script-src 'strict-dynamic' 'unsafe-eval' 'wasm-unsafe-eval' {hashes}",
    "style-src 'unsafe-inline'",
    "img-src data: blob:",
    "font-src data:",
    "connect-src data: blob:",
    "worker-src data: blob:",
    "base-uri 'none'",
    "form-action 'none'",
)


def script_json(data: Any) -> str:
    """Return data as an expression of JavaScript that cannot end its script element."""
    text = json.dumps(data, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def with_policy(html: str) -> str:
    """Add a content security policy that allows the present scripts of a page, and no network.

    Raises:
        ValueError: viser's page has no place for the policy.
    """
    before, first, rest = html.partition(FIRST)
    if not first or SCRIPT.search(before):
        raise ValueError("viser: got a page without a charset first, expected that of viser 1")
    hashes = " ".join(dict.fromkeys(script_hash(m[1]) for m in SCRIPT.finditer(rest)))
    policy = "; ".join(DIRECTIVES).format(hashes=hashes)
    meta = f'<meta http-equiv="Content-Security-Policy" content="{policy}" />'
    return f"{before}{first}\n    {meta}{rest}"


def script_hash(text: str) -> str:
    """Return the source expression of a script's hash."""
    digest = hashlib.sha256(text.replace("\r\n", "\n").replace("\r", "\n").encode()).digest()
    return f"'sha256-{base64.b64encode(digest).decode()}'"
