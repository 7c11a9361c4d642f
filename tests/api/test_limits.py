"""Limits under many requests at once, and what a refused request leaves behind: nothing."""

from __future__ import annotations

import os
import shutil
import socket
import subprocess
import sys
from collections import Counter
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi import FastAPI
from sqlalchemy import func, select

from api.app import create_app
from bench.soak.servers import free_port
from store.db import Database
from store.models import Inspection, Reservation, Upload
from tests.api.conftest import ROOT, TUS, Backend, client_of, wait_until
from tests.api.test_submit import leftovers, post, rows
from tests.databases import BOTH, database

pytestmark = pytest.mark.slow

AT_ONCE = 50
GIB = 1 << 30


@dataclass
class Fleet:
    """Two server processes over one database and one folder."""

    db: Database
    addresses: list[str]
    uploads: Path

    def at_once(self, ask: Callable[[httpx.Client, int], httpx.Response]) -> list[httpx.Response]:
        """`AT_ONCE` requests in parallel, spread over the servers."""
        clients = [httpx.Client(base_url=address, timeout=60) for address in self.addresses]
        with ThreadPoolExecutor(AT_ONCE) as pool:
            return list(pool.map(lambda number: ask(clients[number % 2], number), range(AT_ONCE)))

    def count(self, table: type[Any]) -> int:
        with self.db.read() as session:
            return int(session.scalar(select(func.count()).select_from(table)) or 0)


@pytest.fixture(params=BOTH)
def fleet(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Fleet]:
    with database(request.param, tmp_path) as db:
        settings = {
            "DATA_DIR": tmp_path / "data",
            "DATABASE_URL": db.engine.url.render_as_string(hide_password=False),
            "MAX_ACTIVE": 3,
            "RESERVE_BYTES": shutil.disk_usage(tmp_path).free - 20 * GIB,
        }
        environment = {**os.environ, **{f"BLADEATLAS_{name}": str(value) for name, value in settings.items()}}
        ports = [free_port(), free_port()]
        words = [sys.executable, "-m", "uvicorn", "--factory", "tests.api.unprobed:create_app", "--log-level", "error"]
        servers = [subprocess.Popen([*words, "--port", str(port)], cwd=ROOT, env=environment) for port in ports]
        try:
            for port in ports:
                wait_until(lambda port=port: _listens(port), 60)  # type: ignore[misc]
            yield Fleet(db, [f"http://127.0.0.1:{port}" for port in ports], tmp_path / "data" / "uploads")
        finally:
            for server in servers:
                server.kill()
                server.wait()


def _listens(port: int) -> bool:
    with socket.socket() as probe:
        return probe.connect_ex(("127.0.0.1", port)) == 0


def test_parallel_requests_to_several_servers_keep_the_limits(fleet: Fleet) -> None:
    def inspect(client: httpx.Client, number: int) -> httpx.Response:
        return client.post("/v1/inspections", files={"video": f"video {number}".encode()})

    answers = fleet.at_once(inspect)
    assert Counter(answer.status_code for answer in answers) == {202: 3, 429: AT_ONCE - 3}
    refused = next(answer for answer in answers if answer.status_code == 429)
    assert (refused.json()["code"], refused.json()["where"]) == ("too_many_active", "max_active")
    assert "max_active is 3" in refused.json()["detail"]
    assert refused.headers["Retry-After"]
    assert (fleet.count(Inspection), fleet.count(Reservation), list(fleet.uploads.iterdir())) == (3, 0, [])
    kept = fleet.uploads.parent / "artifacts" / "inputs"
    assert len(list(kept.iterdir())) == 3, "the video of a refused request is not stored"

    def upload(client: httpx.Client, _: int) -> httpx.Response:
        return client.post("/v1/uploads", headers={**TUS, "Upload-Length": str(6 * GIB)})

    answers = fleet.at_once(upload)
    begun = sum(answer.status_code == 201 for answer in answers)
    # Three fit into 20 GiB; others who write to the same disk meanwhile may take or give a little.
    assert 2 <= begun <= 3, Counter(answer.status_code for answer in answers)
    assert {answer.json()["code"] for answer in answers if answer.status_code != 201} == {"disk_full"}
    assert fleet.count(Upload) == len(list(fleet.uploads.iterdir())) == begun


def test_parallel_retries_keep_the_limit(backend: Backend, serve: Callable[[FastAPI], str]) -> None:
    names = [backend.finished(f"number {number}") for number in range(20)]
    address = serve(create_app(backend.with_settings(max_active=3).services))
    anew = {"from_stage": next(iter(backend.services.graph.stages))}
    with ThreadPoolExecutor(20) as pool:
        ask: Callable[[str], int] = lambda name: (  # noqa: E731
            httpx.post(f"{address}/v1/inspections/{name}/retry", json=anew, timeout=60).status_code
        )
        found = Counter(pool.map(ask, names))
    assert found == {202: 3, 429: 17}
    assert Counter(row.state for row in rows(backend)) == {"queued": 3, "succeeded": 17}
    kept = [path for path in backend.services.inspections.known_results().values() if path.startswith("split/")]
    assert len(kept) == 17, "a retry that was refused cost no result"


def test_a_retry_that_is_refused_costs_no_result(backend: Backend) -> None:
    done = backend.finished("done")
    backend.create("one")
    results = backend.services.inspections.known_results()
    assert results
    client = client_of(backend.with_settings(max_active=1))
    stage = next(iter(backend.services.graph.stages))
    answer = client.post(f"/v1/inspections/{done}/retry", json={"from_stage": stage})
    assert (answer.status_code, answer.json()["code"]) == (429, "too_many_active")
    assert backend.services.inspections.known_results() == results


def test_open_uploads_are_counted(backend: Backend) -> None:
    client = client_of(backend.with_settings(max_open_uploads_per_owner=2))
    begin = {**TUS, "Upload-Length": "10"}
    url = client.post("/v1/uploads", headers=begin).headers["Location"]
    client.post("/v1/uploads", headers={**TUS, "Upload-Length": "0"})
    answer = client.post("/v1/uploads", headers=begin)
    assert (answer.status_code, answer.json()["code"]) == (429, "too_many_uploads_of_owner")
    assert answer.headers["Retry-After"]
    assert len(leftovers(backend)) == 2
    client.delete(url, headers=TUS)
    assert client.post("/v1/uploads", headers=begin).status_code == 201


@pytest.fixture
def small_disk(backend: Backend, monkeypatch: pytest.MonkeyPatch) -> Backend:
    """Room for 10 GiB."""
    usage = type(shutil.disk_usage("/"))(30 * GIB, 15 * GIB, 15 * GIB)
    monkeypatch.setattr("store.admission.shutil.disk_usage", lambda _folder: usage)
    return backend.with_settings(reserve_bytes=5 * GIB)


@pytest.mark.usefixtures("unprobed")
def test_a_form_promises_its_length_while_it_comes_in(small_disk: Backend, serve: Callable[[FastAPI], str]) -> None:
    address = serve(create_app(small_disk.services))
    begin = {**TUS, "Upload-Length": str(3 * GIB)}
    head = "POST /v1/inspections HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: multipart/form-data; boundary=b\r\n"
    place = ("127.0.0.1", int(address.rsplit(":", 1)[1]))
    with socket.create_connection(place) as form, socket.create_connection(place, timeout=20) as other:
        form.sendall(f"{head}Content-Length: {8 * GIB}\r\n\r\n--b\r\n".encode())
        wait_until(lambda: _reserved(small_disk) == 1)
        answer = httpx.post(f"{address}/v1/uploads", headers=begin)
        assert (answer.status_code, answer.json()["code"]) == (507, "disk_full")
        assert answer.headers["Retry-After"]
        other.sendall(f"{head}Content-Length: {3 * GIB}\r\n\r\n".encode())
        assert other.recv(100).startswith(b"HTTP/1.1 507 "), "before any of it is read"
    wait_until(lambda: _reserved(small_disk) == 0)
    assert httpx.post(f"{address}/v1/uploads", headers=begin).status_code == 201
    assert len(leftovers(small_disk)) == 1


@pytest.mark.usefixtures("unprobed")
def test_a_form_without_a_length_promises_what_comes(small_disk: Backend) -> None:
    body = b'--b\r\nContent-Disposition: form-data; name="video"; filename="v"\r\n\r\nx\r\n--b--\r\n'
    chunks = {"content": iter([body]), "headers": {"Content-Type": "multipart/form-data; boundary=b"}}
    assert client_of(small_disk).post("/v1/inspections", **chunks).status_code == 202
    full = client_of(small_disk.with_settings(reserve_bytes=15 * GIB - 10))
    chunks["content"] = iter([body])
    answer = full.post("/v1/inspections", **chunks)
    assert (answer.status_code, answer.json()["code"]) == (507, "disk_full")
    assert (_reserved(small_disk), leftovers(small_disk)) == (0, [])


@pytest.mark.usefixtures("unprobed")
def test_forms_count_as_open_uploads(backend: Backend) -> None:
    client = client_of(backend.with_settings(max_open_uploads=1))
    assert post(client).status_code == 202
    client.post("/v1/uploads", headers={**TUS, "Upload-Length": "10"})
    answer = post(client)
    assert (answer.status_code, answer.json()["code"]) == (429, "too_many_uploads")


def _reserved(backend: Backend) -> int:
    with backend.db.read() as session:
        return int(session.scalar(select(func.count()).select_from(Reservation)) or 0)
