"""A server that many connect to who do not say what they want."""

from __future__ import annotations

import asyncio
import logging
import socket
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager

import httpx
import pytest
import uvicorn

from api.app import create_app
from api.connections import config_of, listeners_on
from core.errors import BadInput
from tests.api.conftest import Backend, Server, wait_until

pytestmark = pytest.mark.slow

_HALF = b"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\nX-Slow: "


@contextmanager
def serving(backend: Backend, **settings: float) -> Iterator[tuple[str, int]]:
    changed = backend.with_settings(**settings)
    config = config_of(create_app(changed.services), changed.services.settings, port=0, log_level="error")
    assert isinstance(config, uvicorn.Config)
    server = Server(config)
    thread = threading.Thread(target=server.run, daemon=True)
    thread.start()
    wait_until(lambda: server.started)
    try:
        address: tuple[str, int] = server.servers[0].sockets[0].getsockname()
        yield address
    finally:
        server.should_exit = True
        thread.join(10)


@pytest.fixture
def connect() -> Iterator[Callable[[tuple[str, int], bytes], socket.socket]]:
    with ExitStack() as opened:

        def one(address: tuple[str, int], said: bytes = _HALF) -> socket.socket:
            made = opened.enter_context(socket.create_connection(address, timeout=10))
            made.sendall(said)
            return made

        yield one


def is_closed(one: socket.socket) -> bool:
    try:
        return one.recv(1) == b""
    except ConnectionResetError:
        return True


Connect = Callable[..., socket.socket]


def test_half_a_request_has_its_time(backend: Backend, connect: Connect) -> None:
    with serving(backend, header_seconds=0.5) as address:
        nothing, half = connect(address, b""), connect(address)
        second = connect(address, b"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n")
        assert second.recv(12) == b"HTTP/1.1 200"
        began = time.monotonic()
        for number in range(30):  # byte by byte does not help
            try:
                half.sendall(b"x")
                second.sendall(b"GET /"[number : number + 1])
            except OSError:
                break
            time.sleep(0.05)
        assert is_closed(nothing)
        assert is_closed(half)
        assert time.monotonic() - began < 3.0
        rest = b""
        while chunk := second.recv(4096):
            rest += chunk
        assert rest.endswith(b'{"status":"ok"}'), "half of a second request on the same connection has no longer"


def test_a_request_that_is_being_answered_is_no_slow_one(backend: Backend) -> None:
    with serving(backend, header_seconds=0.3) as (host, port):
        waiting = backend.create("one")
        answer = httpx.get(f"http://{host}:{port}/v1/inspections/{waiting}", params={"wait": 1.5}, timeout=10)
    assert answer.status_code == 200
    assert answer.elapsed.total_seconds() > 1.0


def test_those_that_wait_give_way_and_the_log_stays_short(
    backend: Backend, connect: Connect, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.WARNING), serving(backend, max_connections=20, header_seconds=60) as address:
        half = [connect(address) for _ in range(120)]
        for _ in range(5):
            assert httpx.get("http://{}:{}/healthz".format(*address), timeout=5).status_code == 200
        assert is_closed(half[0])
        half[-1].settimeout(0.2)
        with pytest.raises(TimeoutError):
            half[-1].recv(1)
    said = [line for line in caplog.text.splitlines() if "connections_dropped" in line]
    assert len(said) == 1, "a hundred fell in the same seconds"


def test_where_all_are_served_a_new_one_is_refused(backend: Backend, connect: Connect) -> None:
    waiting = backend.create("one")
    poll = f"GET /v1/inspections/{waiting}?wait=5 HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n".encode()
    with serving(backend, max_connections=3) as address:
        polls = [connect(address, poll) for _ in range(3)]
        time.sleep(0.3)
        refused = connect(address, b"")
        assert refused.recv(4096).startswith(b"HTTP/1.1 503 ")
        assert is_closed(refused)
        polls[0].close()
        wait_until(
            lambda: connect(address, b"GET /healthz HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n").recv(12)[9:12] == b"200"
        )


def test_of_many_that_come_at_once_few_are_taken_in_before_others_are_served(backend: Backend) -> None:
    config = config_of(create_app(backend.services), backend.services.settings)
    listener = listeners_on("127.0.0.1", 0)[0]
    rounds: list[int] = []

    async def serve() -> list[int]:
        loop, looked = asyncio.get_running_loop(), 0

        def taken_in() -> asyncio.Protocol:
            rounds.append(looked)
            return asyncio.Protocol()

        server = await loop.create_server(taken_in, sock=listener, backlog=config.backlog)
        with ExitStack() as opened:
            for _ in range(200):  # in this very turn of the loop, so that all of them knock before it looks
                opened.enter_context(socket.create_connection(listener.getsockname(), timeout=10))
            while len(rounds) < 200:
                looked += 1
                await asyncio.sleep(0)
            server.close()
        return rounds

    taken = Counter(asyncio.run(asyncio.wait_for(serve(), 20)))
    assert max(taken.values()) < 50, "uvicorn's own way takes all of them at once"


def test_a_port_that_is_in_use_is_named() -> None:
    with listeners_on("127.0.0.1", 0)[0] as other:
        other.listen()
        with pytest.raises(BadInput, match=r"port \d+: Address already in use"):
            listeners_on("127.0.0.1", other.getsockname()[1])
