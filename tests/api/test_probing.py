"""Looking into strangers' videos: one after the other, fair, limited, and without anything of ours in reach."""

from __future__ import annotations

import ast
import asyncio
import os
import socket
import time
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import httpx
import psutil
import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient

from api.app import create_app
from api.probing import Prober
from core.errors import BadInput
from core.settings import make_settings
from core.videos import Recording
from store.settings import DeploymentSettings
from tests.api.conftest import VIDEO, Backend, client_of, wait_until
from tests.api.test_submit import leftovers, post, rows
from tests.inputs import INPUTS

pytestmark = pytest.mark.slow

BIG = INPUTS / "big180.mp4"


class Flood:
    """Many posts of one owner and single ones of another, on a real server."""

    def __init__(self, backend: Backend, serve: Callable[[FastAPI], str]) -> None:
        self.backend = backend
        self.app = create_app(backend.services)
        self.turns = self.app.state.bladeatlas.prober.turns
        self.address = serve(self.app)
        self.headers = {name: backend.key(name) for name in ("many", "one")}

    async def post(self, client: httpx.AsyncClient, owner: str, video: bytes) -> httpx.Response:
        files = {"video": ("v.mp4", video)}
        return await client.post("/v1/inspections", files=files, headers=self.headers[owner])

    async def run(self, posts: int, video: bytes, waiting: int) -> tuple[httpx.Response, list[httpx.Response], int]:
        """Begin all posts of the one, then send one of the other.

        Returns:
            Its answer, those that came before it, and how many inspections were there when all clients went away.
        """
        limits = httpx.Limits(max_connections=None)
        async with httpx.AsyncClient(base_url=self.address, timeout=60, limits=limits) as client:
            many = [asyncio.create_task(self.post(client, "many", video)) for _ in range(posts)]
            while self.turns.waiting < waiting:
                await asyncio.sleep(0.02)
            answer = await self.post(client, "one", video)
            done = [task.result() for task in many if task.done()]
            for task in many:
                task.cancel()
            await asyncio.gather(*many, return_exceptions=True)
            return answer, done, len(rows(self.backend))


def open_files() -> Counter[str]:
    """What this process holds open, but for the database's files, which a pool of connections keeps."""
    found: Counter[str] = Counter()
    for descriptor in Path("/proc/self/fd").iterdir():
        with suppress(FileNotFoundError):
            target = str(descriptor.readlink())
            if "bladeatlas.db" not in target:
                found[target.split(":")[0]] += 1
    return found


@pytest.fixture
def started() -> Callable[[], set[int]]:
    """Processes that this one has started since the test began; helpers of other tests live as long as all of them."""
    before = {child.pid for child in psutil.Process().children()}
    return lambda: {child.pid for child in psutil.Process().children()} - before


def test_a_hundred_posts_of_one_owner_do_not_keep_another_waiting(
    backend: Backend,
    serve: Callable[[FastAPI], str],
    monkeypatch: pytest.MonkeyPatch,
    started: Callable[[], set[int]],
) -> None:
    monkeypatch.setattr("api.probing._ENTRY", "tests.api.slow_probe")
    flood = Flood(backend.with_settings(max_probes_waiting_per_owner=40, probe_seconds=60), serve)
    httpx.get(f"{flood.address}/healthz")
    files = open_files()
    began = time.monotonic()
    answer, done, accepted = asyncio.run(flood.run(100, b"any bytes", waiting=40))
    assert answer.status_code == 202, answer.text
    found = Counter(response.status_code for response in done)
    assert found[202] < 20, "in the order of their coming it would have been the last"
    assert found[429] > 10
    refused = next(response for response in done if response.status_code == 429)
    assert refused.json()["code"] == "too_many_probes_of_owner"
    assert refused.headers["Retry-After"]
    assert "max_probes_waiting_per_owner" in refused.json()["detail"]
    assert time.monotonic() - began < 30

    # All clients have gone: nobody waits for them any more, and nothing of theirs is left.
    wait_until(lambda: flood.turns.waiting == 0 and not started())
    wait_until(lambda: leftovers(backend) == [])
    wait_until(lambda: sum(open_files().values()) <= sum(files.values()))
    wait_until(lambda: backend.db.engine.pool.checkedout() == 0)  # type: ignore[attr-defined]
    # What was being looked into then, and no more.
    assert len(rows(backend)) <= accepted + 3, "a client that went away while it waited made no inspection"
    headers = flood.headers["many"]
    again = httpx.post(f"{flood.address}/v1/inspections", files={"video": b"x"}, headers=headers, timeout=30)
    assert again.status_code == 202


def test_real_looks_take_turns(backend: Backend, serve: Callable[[FastAPI], str]) -> None:
    flood = Flood(backend.with_settings(probe_seconds=60), serve)
    answer, done, _ = asyncio.run(flood.run(6, b"no video", waiting=4))
    assert (answer.status_code, answer.json()["code"]) == (422, "not_a_video")
    assert len(done) < 6
    wait_until(lambda: flood.turns.waiting == 0)


def test_a_look_beyond_its_processor_time_is_ended(
    backend: Backend, monkeypatch: pytest.MonkeyPatch, started: Callable[[], set[int]]
) -> None:
    monkeypatch.setattr("api.probing._ENTRY", "tests.api.slow_probe")
    client = client_of(backend.with_settings(probe_seconds=1, probe_memory_bytes=8 << 30))
    answer = post(client, parameters='{"options": {"roi.x0": 0.5}}')
    assert (answer.status_code, answer.json()["code"]) == (422, "probe_timeout"), answer.text
    assert "probe_seconds" in answer.json()["detail"]
    assert not started()


def test_a_machine_that_is_too_busy_is_not_the_videos_fault(
    backend: Backend, monkeypatch: pytest.MonkeyPatch, started: Callable[[], set[int]]
) -> None:
    monkeypatch.setattr("api.probing._ENTRY", "tests.api.slow_probe")
    answer = post(client_of(backend.with_settings(probe_seconds=0.05)))
    assert (answer.status_code, answer.json()["code"], answer.json()["retryable"]) == (503, "probe_busy", True)
    assert answer.headers["Retry-After"]
    assert not started()


def test_a_video_beyond_a_limit_is_refused(backend: Backend, client: TestClient) -> None:
    answer = post(client, BIG.read_bytes())
    assert (answer.status_code, answer.json()["code"], answer.json()["where"]) == (422, "too_many_pixels", "video")
    assert "8192x8192" in answer.json()["detail"]
    short = post(client_of(backend.with_settings(max_video_frames=95)), VIDEO.read_bytes())
    assert (short.status_code, short.json()["code"]) == (422, "too_many_frames")
    assert (rows(backend), leftovers(backend)) == ([], [])


def test_limits_are_told(backend: Backend) -> None:
    client: TestClient = client_of(backend.with_settings(max_frame_pixels=77, max_open_uploads_per_owner=5))
    told = client.get("/v1/limits").json()
    settings = DeploymentSettings().model_copy(update={"max_frame_pixels": 77, "max_open_uploads_per_owner": 5})
    for name in (
        *("max_active", "max_active_per_owner", "max_open_uploads", "max_open_uploads_per_owner"),
        *("max_frame_pixels", "max_video_frames", "max_video_seconds", "probe_seconds", "probe_wait_seconds"),
        *("max_probes_waiting", "max_probes_waiting_per_owner"),
        *("task_seconds", "task_cpu_seconds", "task_memory_bytes", "task_address_bytes", "task_file_bytes"),
    ):
        assert told[name] == getattr(settings, name), name


def test_a_look_has_no_credential(backend: Backend, monkeypatch: pytest.MonkeyPatch) -> None:
    """The environment of the real process, as the kernel shows it."""
    for name in ("BLADEATLAS_DATABASE_URL", "BLADEATLAS_BROKER_URL", "AWS_SECRET_ACCESS_KEY", "PGPASSWORD"):
        monkeypatch.setenv(name, "marked-credential")

    async def watch() -> str:
        prober = Prober(backend.services.settings)
        check = asyncio.create_task(prober.check("me", [Recording(VIDEO)], make_settings()))
        seen = ""
        while not check.done():
            for child in psutil.Process().children():
                with suppress(psutil.Error, OSError):  # it ends when it likes
                    if "core.intake" in child.cmdline():
                        seen = Path(f"/proc/{child.pid}/environ").read_text() or seen
            await asyncio.sleep(0.01)
        await check
        return seen

    environment = asyncio.run(watch())
    assert "PATH=" in environment
    assert "marked-credential" not in environment


def test_a_look_reaches_nobody(backend: Backend, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """Nor the server's memory: where that runs as root its child has given up what reading it takes."""
    monkeypatch.setattr("api.probing._ENTRY", "tests.api.reaching_probe")
    with socket.socket() as listening:
        listening.bind(("127.0.0.1", 0))
        listening.listen()
        video = tmp_path / "video"
        video.write_text(str(listening.getsockname()[1]))
        with socket.create_connection(listening.getsockname(), timeout=5):
            pass  # it can be reached
        with pytest.raises(BadInput) as said:
            asyncio.run(Prober(backend.services.settings).check("me", [Recording(video)], make_settings()))
    outcomes = {"port": "PermissionError"}
    if os.getuid() == 0:
        outcomes["parent"] = "PermissionError"
    assert outcomes.items() <= ast.literal_eval(said.value.message).items()
