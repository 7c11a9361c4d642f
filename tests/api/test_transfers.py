"""Transfers of inputs by URL that outlive the process that fetches, and are known to every other one."""

from __future__ import annotations

import errno
import hashlib
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

import httpx
import pytest
from fastapi import FastAPI
from sqlalchemy import select

from bench.soak.servers import free_port
from cli.serve import _application
from store.db import Database
from store.files import input_key
from store.integration_models import Transfer
from store.leasing import input_files
from store.models import Inspection, Upload
from store.transfers import WantedFile
from store.uploads import UploadFile
from tests.api.conftest import ROOT, Backend, wait_until
from tests.api.fetching import Place, kept, make_place, refused, uploads_left
from tests.api.file_server import DATA, HERE, Files
from tests.databases import BOTH, database

pytestmark = pytest.mark.slow

MIB = 1 << 20
ONE_EACH = {"max_open_uploads_per_owner": 1, "max_fetches_per_owner": 1}
"""What is taken over is nothing more: with these limits it would be refused otherwise."""


SHORT = {"lease_s": 0.4, "heartbeat_s": 0.1}
"""A lease is over soon after its holder died."""


@dataclass
class Two:
    """Two processes of the API, which have a database and a folder in common."""

    first: Place
    second: Place

    def rows(self) -> list[Upload]:
        with self.first.backend.db.read() as session:
            return list(session.scalars(select(Upload)))

    def in_the_middle(self) -> bool:
        return any(0 < row.offset < row.length for row in self.rows())

    def leased_until(self) -> datetime:
        with self.first.backend.db.read() as session:
            until = session.scalars(select(Transfer)).one().lease_expires_at
        assert until is not None
        return until

    def leftovers(self) -> list[Path]:
        return list(self.first.backend.services.settings.folder("uploads").iterdir())


@pytest.fixture
def two(
    request: pytest.FixtureRequest,
    backend: Backend,
    files: Files,
    serve: Callable[[FastAPI], str],
    unprobed: None,
    monkeypatch: pytest.MonkeyPatch,
) -> Two:
    """A test may say how long leases hold, how often they are renewed, and more settings."""
    monkeypatch.setattr("api.transferring._COMMIT_S", 0.0)
    settings = {**ONE_EACH, **getattr(request, "param", {})}
    made = Two(*(make_place(backend, files, serve, **settings) for _ in range(2)))
    made.first.app.state.bladeatlas.fetches.wait_s = 0.1
    return made


@pytest.fixture
def stop(files: Files) -> Iterator[threading.Event]:
    """The first answer of the file server comes to its middle, and further once this is set."""
    made = threading.Event()
    files.stops = [made]
    yield made
    made.set()


@pytest.fixture
def breaks_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """The disk fails in the moment of the second piece, as nobody expects."""
    write, failed = UploadFile.write, threading.Event()

    def fails(file: UploadFile, data: bytes) -> None:
        if file.offset and not failed.is_set():
            failed.set()
            raise OSError(errno.EIO, "the disk fails")
        write(file, data)

    monkeypatch.setattr(UploadFile, "write", fails)


@pytest.mark.parametrize("two", [{"heartbeat_s": 0.1}], indirect=True)
def test_every_process_knows_how_far_a_transfer_is(two: Two, files: Files, stop: threading.Event) -> None:
    assert two.first.post(video_url=files.url()).status_code == 409
    wait_until(two.in_the_middle)
    until = two.leased_until()
    wait_until(lambda: two.leased_until() > until)  # also when no byte comes
    two.second.app.state.bladeatlas.fetches.wait_s = 0.1
    told = two.second.post(video_url=files.url())
    assert (told.status_code, told.json()["code"]) == (409, "fetching")
    assert told.json()["detail"].startswith(f"{two.rows()[0].offset} of {len(DATA)} bytes")
    stop.set()
    assert kept(two.second, two.second.post_until(video_url=files.url())) == [DATA]
    assert len(files.asked) == 1
    assert (uploads_left(two.first), two.leftovers()) == (0, [])


def test_what_cannot_be_had_is_told_by_any_process_and_once(two: Two, files: Files, stop: threading.Event) -> None:
    wrong = {"video_url": files.url(), "video_sha256": "0" * 64}
    assert two.first.post(**wrong).status_code == 409
    stop.set()
    assert refused(two.second.post_until(**wrong)) == (422, "checksum", "/video_url")
    assert len(files.asked) == 1
    assert refused(two.second.post_until(**wrong)) == (422, "checksum", "/video_url")
    assert len(files.asked) == 2
    assert (uploads_left(two.first), two.leftovers()) == (0, [])


@pytest.mark.parametrize("two", [SHORT], indirect=True)
@pytest.mark.parametrize("tag", ['"one"', ""])
@pytest.mark.usefixtures("breaks_once")
def test_a_transfer_that_broke_off_goes_on_in_its_upload(two: Two, files: Files, tag: str) -> None:
    files.tag = tag
    two.first.app.state.bladeatlas.fetches.wait_s = 20.0
    assert two.first.post(video_url=files.url()).status_code == 500
    (before,) = two.rows()
    assert MIB <= before.offset < before.length == len(DATA)
    sha256 = hashlib.sha256(DATA).hexdigest()
    answer = two.second.post_until(video_url=files.url())
    assert kept(two.second, answer) == [DATA]
    assert [(row.id, row.sha256) for row in two.rows()] == [(before.id, sha256)]
    assert [wanted for _, wanted in files.asked] == ["", f"bytes={before.offset}-" if tag else ""]
    assert (uploads_left(two.first), two.leftovers()) == (0, [])


@pytest.mark.parametrize("two", [SHORT], indirect=True)
@pytest.mark.usefixtures("breaks_once")
def test_addresses_are_checked_again_when_a_transfer_is_taken_over(two: Two, files: Files) -> None:
    two.first.app.state.bladeatlas.fetches.wait_s = 20.0
    assert two.first.post(video_url=files.url()).status_code == 500
    two.second.leads_to = lambda name, times: ["127.0.0.1"]
    assert refused(two.second.post_until(video_url=files.url())) == (422, "private_address", "/video_url")
    assert len(files.asked) == 1
    assert (uploads_left(two.first), two.leftovers()) == (0, [])


@pytest.mark.parametrize("two", [{**SHORT, "max_open_uploads_per_owner": 2}], indirect=True)
@pytest.mark.usefixtures("breaks_once")
def test_who_has_no_place_for_a_transfer_now_refuses_none_that_was_begun(two: Two, files: Files) -> None:
    stop = threading.Event()
    two.first.app.state.bladeatlas.fetches.wait_s = 20.0
    assert two.first.post(video_url=files.url()).status_code == 500
    fetches = two.second.app.state.bladeatlas.fetches
    fetches.wait_s, files.stops, files.content["/slow"] = 0.1, [stop], DATA[:MIB]
    assert two.second.post(video_url=files.url("/slow")).json()["code"] == "fetching"
    time.sleep(SHORT["lease_s"])
    assert two.second.post(video_url=files.url()).json()["code"] == "fetching"
    assert two.second.post(video_url=files.url("/notes")).json()["code"] == "too_many_fetches_of_owner"
    assert [path for path, _ in files.asked] == ["/video", "/slow"]
    stop.set()
    fetches.wait_s = 20.0
    assert kept(two.second, two.second.post_until(video_url=files.url())) == [DATA]


@pytest.mark.parametrize("two", [{"lease_s": 0.4, "heartbeat_s": 60.0}], indirect=True)
def test_who_stands_still_loses_the_lease_and_writes_nothing_more(
    two: Two, files: Files, stop: threading.Event
) -> None:
    assert two.first.post(video_url=files.url()).status_code == 409
    wait_until(two.in_the_middle)
    assert kept(two.second, two.second.post_until(video_url=files.url())) == [DATA]
    stop.set()
    wait_until(lambda: not two.first.app.state.bladeatlas.fetches._under_way)
    assert [wanted for _, wanted in files.asked] == ["", ""], "the first had its file still open"
    assert sorted(row.offset == row.length for row in two.rows()) == [False, True]
    assert (uploads_left(two.first), two.leftovers()) == (0, [])


def test_a_server_that_starts_again_frees_what_it_was_fetching(backend: Backend) -> None:
    services, wanted = backend.services, [WantedFile("https://files.test/", None, 1)]
    for holder in ("me", "another"):
        assert services.transfers.begin(holder, "default", wanted, holder) is not None
    app = _application(services.settings, services.db, services.graph, services.wake, "me")
    assert app.state.bladeatlas.services.name == "me"
    free = {name: view.free for name in ("me", "another") if (view := services.transfers.find(name))}
    assert free == {"me": True, "another": False}


@dataclass
class Fleet:
    """Processes of the API over one database and one folder."""

    db: Database
    folder: Path
    environment: dict[str, str]
    servers: list[tuple[str, subprocess.Popen[bytes]]]

    def upload(self) -> Upload:
        """The only one that there ever was."""
        with self.db.read() as session:
            return session.scalars(select(Upload)).one()

    def has_a_part(self) -> bool:
        with self.db.read() as session:
            return bool(session.scalar(select(Upload.offset)))


@pytest.fixture(params=BOTH)
def fleet(request: pytest.FixtureRequest, tmp_path: Path, files: Files) -> Iterator[Fleet]:
    with database(request.param, tmp_path) as db:
        settings = {
            "DATA_DIR": tmp_path / "data",
            "DATABASE_URL": db.engine.url.render_as_string(hide_password=False),
            "RESERVE_BYTES": 0,
            "INPUT_HOSTS": f"{HERE}:{files.port}",
            "OUTBOUND_NETWORKS": f"{HERE}/32",
            "LEASE_S": 1.0,
            "HEARTBEAT_S": 0.3,
            **{name.upper(): value for name, value in ONE_EACH.items()},
        }
        environment = {**os.environ, **{f"BLADEATLAS_{name}": str(value) for name, value in settings.items()}}
        words = [sys.executable, "-m", "uvicorn", "--factory", "tests.api.unprobed:create_app", "--log-level", "error"]
        made = Fleet(db, tmp_path / "data", environment, [])
        try:
            for port in (free_port(), free_port()):
                process = subprocess.Popen([*words, "--port", str(port)], cwd=ROOT, env=environment)
                made.servers.append((f"http://127.0.0.1:{port}", process))
            for address, _ in made.servers:
                wait_until(lambda address=address: _answers(address), 60)  # type: ignore[misc]
            yield made
        finally:
            for _, process in made.servers:
                process.kill()
                process.wait()


def _answers(address: str) -> bool:
    try:
        return httpx.get(f"{address}/healthz").status_code == 200
    except httpx.TransportError:
        return False


@pytest.mark.deployment
def test_another_process_completes_what_a_killed_one_was_fetching(
    fleet: Fleet, files: Files, stop: threading.Event
) -> None:
    (first, process), (second, _) = fleet.servers
    video, files.piece_s = DATA * 4, 0.03
    files.content["/video"] = video
    body = {"video_url": files.url(host=HERE), "video_sha256": hashlib.sha256(video).hexdigest()}

    def kill() -> None:
        wait_until(fleet.has_a_part)
        process.kill()

    killer = threading.Thread(target=kill)
    killer.start()
    with pytest.raises(httpx.TransportError):
        httpx.post(f"{first}/v1/inspections", json=body, timeout=60)
    killer.join()
    process.wait()
    came = fleet.upload().offset
    assert 0 < came < len(video)
    files.piece_s = 0.0
    answer = httpx.post(f"{second}/v1/inspections", json=body, timeout=60)
    assert answer.status_code == 202, answer.text
    assert [wanted for _, wanted in files.asked] == ["", f"bytes={came}-"]
    upload = fleet.upload()
    assert (upload.sha256, upload.removed_at is not None) == (body["video_sha256"], True)
    assert list((fleet.folder / "uploads").iterdir()) == []
    with fleet.db.read() as session:
        (row,) = session.scalars(select(Inspection))
        (one,) = input_files(row)
    assert row.id == answer.json()["id"]
    assert (fleet.folder / "artifacts" / input_key(one.video_sha256, "video")).read_bytes() == video
