"""Connections of the server: how many, and how long one may take to say what it wants.

uvicorn ends a connection that is idle after an answer, but waits for ever for a first request, and for the rest of one
whose header has begun. Here each has a few seconds for it. Of those that come at once few are
taken in before others are answered. When as many are open as may be, the one that has waited
longest without a whole request gives way to the new one; a new one is refused only when all others are being served.
"""

from __future__ import annotations

import asyncio
import resource
import socket
import time
from dataclasses import dataclass, field
from typing import Any

import uvicorn
from fastapi import FastAPI
from uvicorn.protocols.http.h11_impl import H11Protocol

from core.errors import BadInput
from store.json_log import logger
from store.settings import DeploymentSettings

_log = logger("bladeatlas.connections")
_SAY_EVERY_S = 10.0
_DESCRIPTORS = 65_536
"""As many as the process asks for, where it may have them."""
_OTHER_DESCRIPTORS = 256
"""Kept for what is no connection: the database, children, logs."""
_TAKEN_AT_ONCE = 16
"""New connections between two looks at those that are open; uvicorn takes 2048, in which time nobody is answered."""
_KNOCKING = 4096
"""Connections that the system may keep until they are taken."""
_UNSENT_BYTES = 128 << 10
"""What the system takes for a client beyond what is on its way. Its own bound are megabytes, which would all be made
and kept for one that asks for a large table and does not read."""
_PER_CONNECTION = 2
"""One is its own, one the file that it sends or receives."""
_BUSY = (
    b"HTTP/1.1 503 Service Unavailable\r\nconnection: close\r\nretry-after: 5\r\ncontent-length: 0\r\n"
    b"cache-control: no-store\r\n\r\n"
)


@dataclass
class ConnectionGate:
    """Counts connections, lets the ones that wait make room, and says now and then how many had to."""

    most: int
    header_s: float
    _open: set[LimitedProtocol] = field(default_factory=set)
    _waiting: dict[LimitedProtocol, None] = field(default_factory=dict)
    """Those without a whole request, the one that has waited longest first."""
    _dropped: dict[str, int] = field(default_factory=dict)
    _said_at: float = float("-inf")

    def enter(self, one: LimitedProtocol) -> bool:
        """Take a new connection in; False when there is no room even without those that wait."""
        if len(self._open) >= self.most:
            oldest = next(iter(self._waiting), None)
            if oldest is None:
                self._note("refused")
                return False
            self._note("gave_way")
            self.leave(oldest)
            oldest.drop()
        self._open.add(one)
        return True

    def leave(self, one: LimitedProtocol) -> None:
        """It is closed."""
        self._open.discard(one)
        self._waiting.pop(one, None)

    def waits(self, one: LimitedProtocol) -> None:
        """It has no request that is whole."""
        if one in self._open:
            self._waiting.setdefault(one)

    def is_served(self, one: LimitedProtocol) -> None:
        """Its request is being answered."""
        self._waiting.pop(one, None)

    def too_slow(self, one: LimitedProtocol) -> None:
        """Its time for a request is over."""
        self._note("too_slow")
        self.leave(one)
        one.drop()

    def _note(self, what: str) -> None:
        """Count, and write down what was counted at most every few seconds: a flood must not fill the log."""
        self._dropped[what] = self._dropped.get(what, 0) + 1
        now = time.monotonic()
        if now - self._said_at >= _SAY_EVERY_S:
            _log.warning("connections_dropped", **self._dropped, open=len(self._open), most=self.most)
            self._said_at, self._dropped = now, {}


class LimitedProtocol(H11Protocol):
    """A connection that passes through a gate."""

    gate: ConnectionGate
    """Of all connections of a server; see `config_of`."""
    _timer: asyncio.TimerHandle | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]  # as in uvicorn
        """Begin to wait for a request, or say that there is no room."""
        super().connection_made(transport)
        if self.gate.enter(self):
            self._look()
        else:
            transport.write(_BUSY)
            transport.close()

    def connection_lost(self, exc: Exception | None) -> None:
        """Make room."""
        self._stop_timer()
        self.gate.leave(self)
        super().connection_lost(exc)

    def data_received(self, data: bytes) -> None:
        """Take bytes in, and see whether a request is whole now."""
        if self.transport.is_closing():  # it was refused: what it wants is not looked at
            return
        super().data_received(data)
        self._look()

    def on_response_complete(self) -> None:
        """Begin to wait for the next request."""
        super().on_response_complete()
        self._look()

    def drop(self) -> None:
        """Close at once, without an answer."""
        self._stop_timer()
        self.transport.abort()

    def _look(self) -> None:
        waiting = self.cycle is None or self.cycle.response_complete
        if self.transport.is_closing() or not waiting:
            self._stop_timer()
            self.gate.is_served(self)
        elif self._timer is None:
            self._timer = self.loop.call_later(self.gate.header_s, self.gate.too_slow, self)
            self.gate.waits(self)

    def _stop_timer(self) -> None:
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None


def config_of(app: FastAPI, settings: DeploymentSettings, **more: Any) -> uvicorn.Config:
    """uvicorn's configuration with the limits on connections of a deployment; `more` is uvicorn's own."""
    most = min(settings.max_connections, (_raise_descriptors() - _OTHER_DESCRIPTORS) // _PER_CONNECTION)
    if most < settings.max_connections:
        meaning = "the system allows this process fewer descriptors than BLADEATLAS_MAX_CONNECTIONS needs (ulimit -n)"
        _log.warning("fewer_connections", most=most, asked=settings.max_connections, meaning=meaning)
    gate = ConnectionGate(max(1, most), settings.header_seconds)
    protocol = type("GatedProtocol", (LimitedProtocol,), {"gate": gate})
    return uvicorn.Config(app, http=protocol, backlog=_TAKEN_AT_ONCE, **more)


class Listener(socket.socket):
    """A socket that keeps many connections waiting, however few the event loop takes at once.

    asyncio has one number for both.
    """

    def listen(self, backlog: int = _KNOCKING, /) -> None:
        """Listen; the number is not looked at."""
        super().listen(max(backlog, _KNOCKING))


def listeners_on(host: str, port: int) -> list[socket.socket]:
    """Bound sockets for every address of a host.

    Raises:
        BadInput: an address is no one of this machine, or is in use.
    """
    made: list[socket.socket] = []
    try:
        found = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
        for family, kind, protocol, _, address in dict.fromkeys(found):
            try:
                one = Listener(family, kind, protocol)
            except OSError:  # a name may have an address of a family that this system does not speak
                continue
            made.append(one)
            one.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
            if hasattr(socket, "TCP_NOTSENT_LOWAT"):
                one.setsockopt(socket.IPPROTO_TCP, socket.TCP_NOTSENT_LOWAT, _UNSENT_BYTES)
            if family == socket.AF_INET6:
                one.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
            one.bind(address)
    except OSError as error:
        for bound in made:
            bound.close()
        message = f"the server cannot listen on '{host}', port {port}: {error.strerror}"
        raise BadInput(message, code="cannot_listen", where="--port") from None
    if not made:
        raise BadInput(f"'{host}' has no address that can be listened on", code="cannot_listen", where="--host")
    return made


def _raise_descriptors() -> int:
    """Raise the soft limit on open files as far as may be; returns what it is then."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = _DESCRIPTORS if hard == resource.RLIM_INFINITY else min(hard, _DESCRIPTORS)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))
        soft = wanted
    return _DESCRIPTORS if soft == resource.RLIM_INFINITY else soft
