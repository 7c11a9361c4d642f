"""The path below which clients see the server, where a proxy before it serves several things under one name.

The proxy takes the prefix off; here it is put before the path again, as ASGI has it (`root_path` is a part of `path`).
So routes match as ever, and what is told to clients (addresses, cookies, `instance` of a problem) is theirs.
"""

from __future__ import annotations

from collections.abc import MutableMapping
from typing import Any

from starlette.types import ASGIApp, Receive, Scope, Send


class PrefixMiddleware:
    """Puts the prefix before the path of every request; to be the first that sees one."""

    def __init__(self, app: ASGIApp, prefix: str) -> None:
        self._app, self._prefix = app, prefix

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass the request on, changed in place: handlers of errors have the same scope."""
        if scope["type"] == "http":
            scope["root_path"] = self._prefix
            scope["path"] = self._prefix + scope["path"]
            if scope.get("raw_path"):
                scope["raw_path"] = self._prefix.encode("ascii") + scope["raw_path"]
        await self._app(scope, receive, send)


def own_path(scope: MutableMapping[str, Any]) -> str:
    """The path of a request without the prefix: what the server itself calls it."""
    path: str = scope["path"]
    return path.removeprefix(prefix_of(scope))


def prefix_of(scope: MutableMapping[str, Any]) -> str:
    """The prefix of a request, without a slash at its end; empty when there is none."""
    prefix: str = scope.get("root_path", "")
    return prefix.rstrip("/")
