"""`bladeatlas serve` without a broker: jobs end, and its own kill -9 costs nothing."""

from __future__ import annotations

import signal
import time
from collections.abc import Iterator
from pathlib import Path

import httpx
import psutil
import pytest

from bench.soak.servers import free_port
from store.db import open_sqlite
from store.keys import Keys
from store.models import Inspection
from tests.waiting import wait_for
from tests.worker.deployment import Deployment
from tests.worker.disks import fill, mounted

pytestmark = pytest.mark.deployment
ALL = ["join", "last", "part/000", "part/001", "split"]


@pytest.fixture
def place(tmp_path: Path) -> Iterator[Deployment]:
    database = open_sqlite(tmp_path / "bladeatlas.db")
    made = Deployment(tmp_path, database, {"BLADEATLAS_LEASE_S": "60"})
    yield made
    made.stop()
    database.close()


def serve(place: Deployment) -> str:
    """Start a server and wait until it answers."""
    port = free_port()
    process = place.start("serve", "--port", str(port), "--workers", "2")
    address = f"http://127.0.0.1:{port}"
    wait_for(lambda: process.poll() is not None or _answers(address))
    assert process.poll() is None, place.said(len(place.processes) - 1)
    return address


def _answers(address: str) -> bool:
    try:
        return httpx.get(f"{address}/healthz").status_code == 200
    except httpx.TransportError:
        return False


def test_a_server_runs_jobs_and_stops_cleanly(place: Deployment) -> None:
    serve(place)
    place.create("one")
    place.wait("one")
    assert place.accepted_once("one")
    logs = sorted(path.name for path in (place.root / "artifacts/logs/one").iterdir())
    assert logs == ["join.log", "last.log", "part__000.log", "part__001.log", "split.log"]
    place.processes[0].send_signal(signal.SIGTERM)
    assert place.processes[0].wait(15) == 0
    assert '"event": "task_ended"' in place.said()


def test_a_full_store_refuses_new_work_and_nothing_else(tmp_path: Path) -> None:
    done, begin = "0" * 32, {"Tus-Resumable": "1.0.0", "Upload-Length": "1000"}
    with mounted(tmp_path / "disk", mebibytes=48) as disk:
        database = open_sqlite(disk / "bladeatlas.db")
        place = Deployment(disk, database, {"BLADEATLAS_RESERVE_BYTES": str(16 << 20)})
        try:
            address = serve(place)
            place.create(done)
            place.wait(done)
            place.create("one", part__000={"sleep_s": 4})
            wait_for(lambda: place.started("one")["part/000"] == 1)
            filler = fill(disk, leave=8 << 20)
            assert httpx.post(f"{address}/v1/uploads", headers=begin).status_code == 507
            files = {"video": ("v.mp4", b"v" * 100)}
            assert httpx.post(f"{address}/v1/inspections", files=files).status_code == 507
            assert httpx.get(f"{address}/v1/inspections/{done}/artifacts/summary.json").status_code == 200
            place.wait("one")
            assert place.accepted_once("one")
            filler.unlink()
            assert httpx.post(f"{address}/v1/uploads", headers=begin).status_code == 201
        finally:
            place.stop()
            database.close()


def test_after_kill_9_nothing_lives_and_the_next_server_goes_on_at_once(place: Deployment) -> None:
    place.create("one", part__000={"sleep_s": 60, "helper": True, "deaf": True, "times": 1})
    serve(place)
    wait_for(lambda: place.started("one")["part/000"] == 1)
    time.sleep(0.5)
    children = psutil.Process(place.processes[0].pid).children(recursive=True)
    assert len(children) >= 3
    place.processes[0].kill()
    time.sleep(3.0)
    alive = [child for child in children if child.is_running() and child.status() != psutil.STATUS_ZOMBIE]
    assert alive == []
    began = time.monotonic()
    serve(place)
    place.wait("one")
    assert time.monotonic() - began < 30.0, "the lease of a minute was waited for"
    assert place.accepted_once("one")
    assert place.started("one")["split"] == 1
    assert not list((place.root / "artifacts/results").glob("*/.tmp-*"))


def test_a_publisher_that_was_cut_off_is_repaired(place: Deployment) -> None:
    serve(place)
    place.create("one")
    place.wait("one")
    place.processes[0].kill()
    before = place.artifacts("one")
    stale = place.root / "artifacts/inspections/one/1/half.bin"
    stale.write_bytes(b"half")
    (stale.parent / "summary.json").unlink()
    with place.db.write() as session:
        row = session.get_one(Inspection, "one")
        row.published = 0
    serve(place)
    place.wait("one")
    assert place.artifacts("one") == before
    assert (stale.parent / "summary.json").is_file()
    # Swept after the commit that shows the files.
    wait_for(lambda: not stale.exists())


def test_a_deleted_inspection_leaves_nothing_but_what_others_use(place: Deployment) -> None:
    serve(place)
    place.create("one")
    place.create("two")
    place.wait("one", "two")
    with place.db.write() as session:
        row = session.get_one(Inspection, "one")
        row.deleted_at = place.db.now(session)
    folder = place.root / "artifacts"
    wait_for(lambda: not (folder / "inspections/one").exists() and not (folder / "logs/one").exists())
    wait_for(lambda: len(list(folder.glob("results/split/*"))) == 1)
    wait_for(lambda: len(list(folder.glob("inputs/*/video"))) == 1)
    assert place.video("two").is_file()
    assert (folder / "inspections/two/1/summary.json").is_file()
    assert place.artifacts("one") == {}
    assert len(list(folder.glob("results/last/*"))) == 1


def test_two_servers_do_not_share_a_folder(place: Deployment) -> None:
    serve(place)
    second = place.start("serve", "--port", str(free_port()))
    assert second.wait(30) == 2
    assert "another server uses" in place.said(1)


def test_until_a_key_was_made_only_loopback_is_served(place: Deployment) -> None:
    refused = place.start("serve", "--host", "0.0.0.0", "--port", str(free_port()))
    assert refused.wait(30) == 2
    assert "no API key was ever made" in place.said()
    keys = Keys(place.db)
    keys.revoke(keys.create("inspector")[0].id)
    port = free_port()
    place.start("serve", "--host", "0.0.0.0", "--port", str(port))
    address = f"http://127.0.0.1:{port}"
    wait_for(lambda: _answers(address))
    assert httpx.get(f"{address}/v1/inspections").status_code == 401, "the last key was revoked before it started"
    assert '"event": "no_valid_key"' in place.said(1)
