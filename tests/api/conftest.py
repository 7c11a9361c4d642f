"""The application on a toy plan: an ASGI client for most, a real server where sockets matter."""

from __future__ import annotations

import hashlib
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import pytest
import uvicorn
from fastapi import FastAPI
from fastapi.testclient import TestClient
from sqlalchemy import update

from api.app import create_app
from api.services import Services, make_services
from bench.soak.servers import free_port
from core.settings import make_settings
from store.account_models import DEFAULT_ACCOUNT, USUAL_SCOPES, Scope
from store.accounts import Accounts
from store.db import Database
from store.factory import open_artifacts, open_database
from store.keys import Keys
from store.models import Artifact, Inspection
from store.publishing import Publishing
from store.records import InputFiles
from store.settings import DeploymentSettings
from store.tables import replace_rows
from tests.api.file_server import Files, files_served
from tests.databases import put_new_tables
from tests.store.small_plan import GRAPH, result_for
from tests.waiting import wait_for

ROOT = Path(__file__).parents[2]
VIDEO = ROOT / "samples" / "turbine.mp4"
ANNOTATIONS = ROOT / "samples" / "turbine.json"
TUS = {"Tus-Resumable": "1.0.0"}


@dataclass
class Backend:
    """A service without workers: the test plays them."""

    services: Services
    woken: list[str] = field(default_factory=list)

    @property
    def db(self) -> Database:
        return self.services.db

    def with_settings(self, **changes: Any) -> Backend:
        settings = self.services.settings.model_copy(update=changes)
        return Backend(replace(self.services, settings=settings), self.woken)

    def key(self, account: str, *scopes: Scope, **more: Any) -> dict[str, str]:
        """Headers with a new key of an account, which is made when it is missing."""
        if account not in (one.id for one in Accounts(self.db).all()):
            Accounts(self.db).create(account)
        key = Keys(self.db).create(f"{account}'s key", account, scopes or USUAL_SCOPES, **more)[1]
        return {"Authorization": f"Bearer {key}"}

    def create(
        self,
        name: str,
        owner: str = DEFAULT_ACCOUNT,
        video: str = "",
        options: dict[str, Any] | None = None,
        **more: Any,
    ) -> str:
        """An inspection as the API would have made it; its id is made from `name`, its video from it or `video`."""
        inspection_id = hashlib.md5(name.encode(), usedforsecurity=False).hexdigest()
        digest = hashlib.sha256((video or name).encode()).hexdigest()
        files = [InputFiles(f"inputs/{digest}/video", digest, None, None)]
        with self.db.write() as session:
            inspections = self.services.inspections
            inspections.create_in(
                session, inspection_id, files, make_settings(options=options), "", owner=owner, **more
            )
        return inspection_id

    def work(self, inspection_id: str, tasks: int = 1000) -> None:
        """Do up to so many tasks of a plan."""
        for _ in range(tasks):
            lease = self.services.plan.lease("worker:1/0", inspection_id=inspection_id)
            if lease is None:
                return
            assert self.services.plan.complete(lease, result_for(lease))

    def publish(self, inspection_id: str, files: dict[str, bytes] | None = None, **rows: Any) -> None:
        """Put files and rows in place and mark the attempt as published."""
        folder = self.services.settings.folder("made")
        folder.mkdir(parents=True, exist_ok=True)
        for path, data in (files or {}).items():
            source = folder / "file"
            source.write_bytes(data)
            key = f"published/{inspection_id}/{path}"
            stored = self.services.artifacts.put(key, source)
            self._artifact(inspection_id, path, key, stored.size, stored.sha256)
        with self.db.write() as session:
            replace_rows(session, inspection_id, rows)
            published = update(Inspection).where(Inspection.id == inspection_id)
            session.execute(published.values(published=Inspection.attempt))

    def finish(self, inspection_id: str) -> None:
        """Publish it without files, as a publisher does."""
        publishing = Publishing(self.db)
        ticket = publishing._take(inspection_id, "publisher")
        assert ticket is not None
        assert publishing.finish(ticket, [], {})

    def _artifact(self, inspection_id: str, path: str, key: str, size: int, sha256: str) -> None:
        media_type = "application/json" if path.endswith(".json") else "application/octet-stream"
        with self.db.write() as session:
            values = {"path": path, "key": key, "size": size, "sha256": sha256, "media_type": media_type}
            session.merge(Artifact(inspection_id=inspection_id, created_at=self.db.now(session), **values))

    def finished(
        self, name: str, files: dict[str, bytes] | None = None, owner: str = DEFAULT_ACCOUNT, **rows: Any
    ) -> str:
        """An inspection that succeeded and is published."""
        inspection_id = self.create(name, owner)
        self.work(inspection_id)
        self.publish(inspection_id, files, **rows)
        return inspection_id


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Files]:
    """A local https server of files, whose authority is trusted."""
    monkeypatch.setenv("SSL_CERT_FILE", str(tmp_path / "ca.pem"))
    with files_served(tmp_path / "ca.pem") as served:
        yield served


@pytest.fixture
def backend(tmp_path: Path) -> Iterator[Backend]:
    settings = DeploymentSettings(data_dir=tmp_path / "data", reserve_bytes=0)
    woken: list[str] = []
    put_new_tables(settings.folder("bladeatlas.db"))
    db, artifacts = open_database(settings), open_artifacts(settings)
    services = make_services(settings, db, artifacts, wake=woken.append, graph=GRAPH)
    yield Backend(services, woken)
    services.db.close()


def client_of(backend: Backend, host: str = "127.0.0.1") -> TestClient:
    """A client on this machine; errors become answers, as behind a real server."""
    return TestClient(
        create_app(backend.services), "http://127.0.0.1", client=(host, 50000), raise_server_exceptions=False
    )


@pytest.fixture
def client(backend: Backend) -> TestClient:
    return client_of(backend)


@pytest.fixture
def unprobed(monkeypatch: pytest.MonkeyPatch) -> None:
    """Take any bytes for a video: for tests of what comes before and after the look into it."""

    async def check(*_: Any) -> None:
        return None

    monkeypatch.setattr("api.probing.Prober.check", check)


class Server(uvicorn.Server):
    """uvicorn in a thread."""

    def install_signal_handlers(self) -> None:
        """Signals are the test runner's."""


def wait_until(condition: Callable[[], bool], seconds: float = 20.0) -> None:
    """`wait_for`, with the timeout that an answer of the API needs."""
    wait_for(condition, seconds)


@pytest.fixture
def serve() -> Iterator[Callable[[FastAPI], str]]:
    """Serves applications on this machine; returns their address."""
    running: list[tuple[Server, threading.Thread]] = []

    def start(app: FastAPI) -> str:
        port = free_port()
        config = uvicorn.Config(app, host="127.0.0.1", port=port, log_level="error", timeout_graceful_shutdown=1)
        server = Server(config)
        thread = threading.Thread(target=server.run, daemon=True)
        thread.start()
        running.append((server, thread))
        wait_until(lambda: server.started)
        return f"http://127.0.0.1:{port}"

    yield start
    for server, thread in running:
        server.should_exit = True
        thread.join(10)


@pytest.fixture
def address(backend: Backend, serve: Callable[[FastAPI], str]) -> str:
    return serve(create_app(backend.services))
