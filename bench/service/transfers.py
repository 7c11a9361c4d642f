"""Uploads beside a bare sink, and a large download by ranges, both with curl."""

from __future__ import annotations

import os
import sys
import threading
import uuid
from datetime import UTC, datetime
from pathlib import Path

from bench.service.deployment import Server, begin_upload, curl, running, serving, upload_arguments
from bench.soak.servers import free_port
from bench.speed.timing import Row, Table, interleaved
from core.settings import make_settings
from core.states import InspectionState
from store.account_models import DEFAULT_ACCOUNT
from store.db import open_sqlite
from store.files import ArtifactStore
from store.inspections import Inspections
from store.models import Artifact, Inspection
from store.records import InputFiles

UPLOAD_BYTES = 400 << 20
DOWNLOAD_BYTES = 1 << 30
PIECES = 4
_MIB = 1 << 20


def uploads(folder: Path, repeat: int) -> Table:
    """One file by tus into the service and by PUT into the sink, in turn."""
    source = random_file(folder / "upload.bin", UPLOAD_BYTES)
    port = free_port()
    environment = {**os.environ, "SINK_FOLDER": str(folder)}
    command = [sys.executable, "-m", "bench.service.sink", str(port)]
    with serving(folder / "data", {}) as server, running(command, port, folder, environment) as sink:
        watch = MemoryWatch(server)
        times = interleaved(
            {
                "service": lambda: curl(*upload_arguments(begin_upload(server, UPLOAD_BYTES), source)),
                "sink": lambda: curl("-H", "Expect:", "-X", "PUT", "-T", str(source), sink.url),
            },
            repeat,
        )
        memory = watch.stop()
    speed = {name: UPLOAD_BYTES / 1e6 / timing.median for name, timing in times.items()}
    return Table(
        "uploads",
        f"{UPLOAD_BYTES // _MIB} MiB by curl, median of {repeat}",
        (
            Row("bare ASGI sink, synced at the end", speed["sink"], "MB/s"),
            Row("the service, tus, hashed and synced", speed["service"], "MB/s"),
            Row("share of the sink", speed["service"] / speed["sink"], "", "at least 0.8"),
            Row("largest memory of the API", memory / _MIB, "MiB", "under 300"),
        ),
    )


def downloads(folder: Path, repeat: int) -> Table:
    """An artifact of 1 GiB fetched in ranges; its bytes are compared."""
    source = random_file(folder / "download.bin", DOWNLOAD_BYTES)
    with serving(folder / "data", {}) as server:
        link = f"{server.url}/v1/inspections/{publish(folder / 'data', source)}/artifacts/large.bin"
        watch = MemoryWatch(server)
        target = folder / "fetched.bin"
        times = interleaved({"ranges": lambda: _fetch(link, target)}, repeat)
        memory = watch.stop()
        same = _equal(source, target)
    return Table(
        "downloads",
        f"{DOWNLOAD_BYTES // _MIB} MiB in {PIECES} ranges by curl, median of {repeat}",
        (
            Row("speed", DOWNLOAD_BYTES / 1e6 / times["ranges"].median, "MB/s"),
            Row("bytes are the same", str(same).lower()),
            Row("largest memory of the API", memory / _MIB, "MiB", "far below the file's size"),
        ),
    )


def _fetch(link: str, target: Path) -> None:
    target.unlink(missing_ok=True)
    step = DOWNLOAD_BYTES // PIECES
    with target.open("wb") as whole:
        for piece in range(PIECES):
            part = target.with_suffix(".part")
            curl("-r", f"{piece * step}-{(piece + 1) * step - 1}", "-o", str(part), link)
            whole.write(part.read_bytes())


def publish(data: Path, source: Path, owner: str = DEFAULT_ACCOUNT) -> str:
    """A finished inspection of an account with one artifact, ``large.bin``, on a server; its id."""
    inspection_id, database = uuid.uuid4().hex, open_sqlite(data / "bladeatlas.db")
    stored = ArtifactStore(data / "artifacts").put(f"inspections/{inspection_id}/1/large.bin", source)
    files = [InputFiles("inputs/none/video", "0" * 64, None, None)]
    with database.write() as session:
        Inspections(database).create_in(session, inspection_id, files, make_settings(), "", owner=owner)
        row = session.get_one(Inspection, inspection_id)
        row.state, row.published = (
            InspectionState.SUCCEEDED,
            row.attempt,
        )  # in one transaction: no runner may begin with it
        session.add(
            Artifact(
                inspection_id=inspection_id,
                path="large.bin",
                key=stored.path,
                size=stored.size,
                sha256=stored.sha256,
                media_type="application/octet-stream",
                created_at=datetime.now(UTC),
            )
        )
    database.close()
    return inspection_id


class MemoryWatch:
    """The largest resident memory of a server until it is stopped."""

    def __init__(self, server: Server) -> None:
        self._server, self._largest = server, 0
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self._thread.start()

    def _watch(self) -> None:
        while not self._stopped.wait(0.05):
            self._largest = max(self._largest, self._server.memory_bytes())

    def stop(self) -> int:
        """Stop watching; bytes."""
        self._stopped.set()
        self._thread.join()
        return self._largest


def random_file(path: Path, size: int) -> Path:
    """Write a file of about `size` bytes, whole MiB, that cannot be compressed."""
    with path.open("wb") as file:
        for _ in range(size // _MIB):
            file.write(os.urandom(_MIB))
    return path


def _equal(one: Path, other: Path) -> bool:
    with one.open("rb") as a, other.open("rb") as b:
        while piece := a.read(_MIB):
            if piece != b.read(_MIB):
                return False
        return not b.read(1)
