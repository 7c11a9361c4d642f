"""The README's walk-through with curl, word for word, against the service in both of its forms."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import httpx
import pytest
from redis import Redis

from bench.soak.servers import free_port
from core.report.csv_form import read_csv
from core.surface.ply import read_mesh
from tests.conftest import service_url
from tests.databases import database_url

pytestmark = [pytest.mark.sample, pytest.mark.long]

ROOT = Path(__file__).parents[1]
START_S, STOP_S = 60.0, 30.0


def walk_through() -> str:
    """The commands between the marks in the README."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    found = re.search(r"<!-- walk-through -->\n```bash\n(.*?)```\n<!-- end -->", text, re.DOTALL)
    assert found is not None
    return found.group(1)


@contextmanager
def running(folder: Path, environment: dict[str, str], *commands: list[str]) -> Iterator[None]:
    """`bladeatlas` processes over one data folder, ended as a service manager would end them."""
    settings = {**os.environ, "BLADEATLAS_DATA_DIR": str(folder / "data"), **environment}
    with (folder / "service.log").open("ab") as log:
        processes = [
            subprocess.Popen(
                [sys.executable, "-m", "cli.main", *command], cwd=ROOT, env=settings, stdout=log, stderr=log
            )
            for command in commands
        ]
    try:
        yield
        for process in processes:
            process.send_signal(signal.SIGTERM)
        assert [process.wait(STOP_S) for process in processes] == [0] * len(processes)
    finally:
        for process in processes:
            process.kill()
            process.wait()


def walk(folder: Path, port: str) -> None:
    """Wait for the server, run the commands, and look at what they fetched."""
    server, end = f"http://127.0.0.1:{port}", time.monotonic() + START_S
    while True:
        try:
            httpx.get(f"{server}/readyz").raise_for_status()
            break
        except httpx.HTTPError:
            assert time.monotonic() < end, (folder / "service.log").read_text()
            time.sleep(0.2)
    # In a folder of its own, because it downloads into where it is called.
    here = folder / "here"
    here.mkdir()
    (here / "samples").symlink_to(ROOT / "samples")
    done = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", walk_through()],
        cwd=here,
        env={**os.environ, "SERVER": server},
        capture_output=True,
        text=True,
        timeout=1500,
        check=False,
    )
    assert (done.returncode, done.stdout.splitlines()[-1:]) == (0, ["succeeded"]), done.stderr
    mesh = read_mesh(here / "mesh_defects.ply")
    assert mesh.colors is not None
    assert len(mesh.faces) > 1000
    red = (mesh.colors[:, 0] > 200) & (mesh.colors[:, 1:] < 60).all(axis=1)
    assert red.any()
    events = list(read_csv(here / "timeline.csv"))
    assert events
    assert {"event_id", "defect_id", "label", "start_s", "end_s"} <= set(events[0])


@pytest.mark.skipif(shutil.which("curl") is None, reason="curl is not installed")
def test_embedded(tmp_path: Path) -> None:
    port = str(free_port())
    with running(tmp_path, {"BLADEATLAS_DATABASE_URL": ""}, ["serve", "--port", port]):
        walk(tmp_path, port)
    assert (tmp_path / "data" / "bladeatlas.db").is_file()


@pytest.mark.service("postgresql")
@pytest.mark.service("redis")
@pytest.mark.skipif(shutil.which("curl") is None, reason="curl is not installed")
def test_distributed(tmp_path: Path) -> None:
    """Celery on Redis, the plan in PostgreSQL, the tasks in a worker of their own."""
    port = str(free_port())
    broker = service_url("redis")
    with database_url("postgresql", tmp_path) as database, Redis.from_url(broker) as redis:
        redis.flushdb()
        environment = {
            "BLADEATLAS_DATABASE_URL": database.render_as_string(hide_password=False),
            "BLADEATLAS_BROKER_URL": broker,
        }
        with running(tmp_path, environment, ["serve", "--port", port], ["worker"]):
            walk(tmp_path, port)
        redis.flushdb()
