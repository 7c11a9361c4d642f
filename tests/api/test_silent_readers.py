"""Clients that ask for much and read nothing: the others are served as if there were none."""

from __future__ import annotations

import select
import socket
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from urllib.parse import urlsplit

import httpx
import pytest
from fastapi import FastAPI
from sqlalchemy import text

from api.app import create_app
from api.services import make_services
from store.factory import open_artifacts, open_database
from store.settings import DeploymentSettings
from tests.api.conftest import Backend
from tests.databases import BOTH, database_url
from tests.store.small_plan import GRAPH

pytestmark = pytest.mark.slow

ROWS = 60_000
READERS = 100
_FILL = """
INSERT INTO detections (inspection_id, task_key, id, key, time_s, label, box_x1, box_y1, box_x2, box_y2, outcome)
WITH RECURSIVE numbers(i) AS (SELECT 0 UNION ALL SELECT i + 1 FROM numbers WHERE i + 1 < :rows)
SELECT :inspection, '', i, 'key', i, 'dent', 0.25, 0.25, 0.5, 0.75, 'mapped' FROM numbers
"""


@pytest.fixture(params=BOTH)
def large(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Backend]:
    """A service on either database."""
    with database_url(request.param, tmp_path) as url:
        settings = DeploymentSettings(
            data_dir=tmp_path, database_url=url.render_as_string(hide_password=False), reserve_bytes=0
        )
        db, artifacts = open_database(settings), open_artifacts(settings)
        yield Backend(make_services(settings, db, artifacts, wake=lambda _: None, graph=GRAPH))
        db.close()


def with_rows(backend: Backend, name: str = "one") -> str:
    """An inspection with a large table and a file of the same size."""
    one = backend.finished(name, {"dense/fused.ply": b"x" * 10_000_000})
    with backend.db.write() as session:
        session.execute(text(_FILL), {"rows": ROWS, "inspection": one})
    return one


@contextmanager
def silent_readers(address: str, paths: list[str]) -> Iterator[None]:
    """Connections that ask and never read; the block begins when every one of them is being answered."""
    target = urlsplit(address)
    with ExitStack() as opened:
        readers = [opened.enter_context(socket.socket()) for _ in paths]
        for reader, path in zip(readers, paths, strict=True):
            reader.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            reader.connect((target.hostname, target.port))
            reader.sendall(f"GET {path} HTTP/1.1\r\nHost: {target.netloc}\r\n\r\n".encode())
        end = time.monotonic() + 20
        waiting = set(readers)
        while waiting and time.monotonic() < end:
            waiting -= set(select.select(list(waiting), [], [], 0.2)[0])
        yield


def test_many_silent_readers_hold_nothing_that_others_need(large: Backend, serve: Callable[[FastAPI], str]) -> None:
    one = f"/v1/inspections/{with_rows(large)}"
    tables = [f"{one}/detections", f"{one}/detections?format=csv"] * (READERS // 2)
    files = [f"{one}/artifacts/dense/fused.ply", f"{one}/archive.zip"] * 5
    others = [one, f"{one}/detections?limit=10", f"{one}/artifacts", "/v1/inspections?limit=1", "/v1/system"]
    address = serve(create_app(large.services))
    with silent_readers(address, tables + files), httpx.Client(base_url=address, timeout=10) as client:
        # Three tries: what a busy machine takes for itself is not the readers' doing.
        rounds = (answer_times(client, others, 100, 2.0) for _ in range(3))
        assert any(took[int(0.99 * len(took)) - 1] < 0.5 for took in rounds)


def answer_times(client: httpx.Client, paths: list[str], times: int, seconds: float) -> list[float]:
    """How long answers take, sorted, of at least so many requests in at least so many seconds; each must be 200."""
    took: list[float] = []
    end = time.monotonic() + seconds
    while time.monotonic() < end or len(took) < times:
        began = time.monotonic()
        answer = client.get(paths[len(took) % len(paths)])
        took.append(time.monotonic() - began)
        assert answer.status_code == 200, answer.text
    return sorted(took)
