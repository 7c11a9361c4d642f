"""The server as strangers reach it: through the proxy of the handbook, and with more connections than descriptors."""

from __future__ import annotations

import resource
import shutil
import socket
import ssl
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import httpx
import psutil
import pytest

from bench.soak.servers import free_port
from store.db import open_sqlite
from store.keys import Keys
from tests.waiting import wait_for
from tests.worker.deployment import ROOT, Deployment
from tests.worker.nginx import NAME, PREFIX, Proxy, proxied
from tests.worker.test_serve import _answers

pytestmark = pytest.mark.deployment
_TUS = {"Tus-Resumable": "1.0.0"}


@pytest.fixture
def place(tmp_path: Path) -> Iterator[Deployment]:
    database = open_sqlite(tmp_path / "bladeatlas.db")
    made = Deployment(tmp_path, database, {"BLADEATLAS_TRUSTED_HOSTS": NAME, "BLADEATLAS_HEADER_SECONDS": "600"})
    yield made
    made.stop()
    database.close()


@pytest.fixture
def many_descriptors() -> Iterator[None]:
    """So many that this process can hold every end of its connections."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (min(4096, hard), hard))
    yield
    resource.setrlimit(resource.RLIMIT_NOFILE, (soft, hard))


def start(place: Deployment, port: int) -> psutil.Process:
    process = place.start("serve", "--port", str(port), "--workers", "1")
    wait_for(lambda: process.poll() is not None or _answers(f"http://127.0.0.1:{port}"))
    assert process.poll() is None, place.said()
    return psutil.Process(process.pid)


def answer_times(port: int) -> list[float]:
    """Seconds of 50 requests one after the other, each on a new connection; the shortest first."""
    times = []
    for _ in range(50):
        began = time.monotonic()
        httpx.get(f"http://127.0.0.1:{port}/v1/inspections", timeout=30).raise_for_status()
        times.append(time.monotonic() - began)
    return sorted(times)


def test_1100_half_open_connections_stop_nobody(place: Deployment, many_descriptors: None) -> None:
    port = free_port()
    place.environment["BLADEATLAS_MAX_CONNECTIONS"] = "1000"
    server = start(place, port)
    log, quiet = len(place.said()), answer_times(port)
    with ExitStack() as held:
        for _ in range(1100):
            one = held.enter_context(socket.create_connection(("127.0.0.1", port), timeout=30))
            one.sendall(b"GET /v1/inspections HTTP/1.1\r\nHost: 127")
        busy = answer_times(port)
        assert server.num_fds() > 1000, "they are held all the while"
        place.create("one")
        place.wait("one")  # its task's pipe may have a number above 1023
    # The machine may be slow by itself; connections that say nothing must not make it slower.
    assert busy[48] < max(0.5, 3 * quiet[48]), (quiet, busy)
    said = place.said()[log:]
    assert said.count("connections_dropped") <= 3
    assert len(said) < 20_000


@contextmanager
def client_of(proxy: Proxy, key: str) -> Iterator[httpx.Client]:
    headers = {"Host": NAME, "Authorization": f"Bearer {key}"}
    trust = ssl.create_default_context(cafile=str(proxy.authority))
    with httpx.Client(base_url=proxy.url, headers=headers, verify=trust, timeout=30) as client:
        yield client


@pytest.fixture
def through(place: Deployment, tmp_path: Path) -> Iterator[httpx.Client]:
    port = free_port()
    key = Keys(place.db).create("through the proxy")[1]
    start(place, port)
    with proxied(tmp_path / "nginx", port) as proxy, client_of(proxy, key) as client:
        yield client


@pytest.mark.tool("nginx")
def test_the_proxy_of_the_handbook_passes_everything_on(place: Deployment, through: httpx.Client) -> None:
    assert through.get("/v1/limits").status_code == 200
    assert through.get("/v1/limits", headers={"Authorization": ""}).status_code == 401, (
        "it is no caller of this machine"
    )
    assert through.get("/v1/limits", headers={"Host": "elsewhere.example.com"}).status_code == 421
    session = through.post("/v1/session")
    assert "Secure" in session.headers["Set-Cookie"], "the server knows that TLS is before it"

    # Larger than any buffer, and its first part is on disk while the rest is still to come.
    made = through.post("/v1/uploads", headers={**_TUS, "Upload-Length": str(8 << 20)})
    url = made.headers["Location"]
    seen: list[int] = []

    def parts() -> Iterator[bytes]:
        yield bytes(6 << 20)
        wait_for(lambda: bool(next((place.root / "uploads").iterdir()).stat().st_size))
        seen.append(next((place.root / "uploads").iterdir()).stat().st_size)
        yield bytes(2 << 20)

    headers = {**_TUS, "Upload-Offset": "0", "Content-Type": "application/offset+octet-stream"}
    assert through.patch(url, content=parts(), headers=headers).headers["Upload-Offset"] == str(8 << 20)
    assert seen[0] > 0

    place.create("one")
    place.wait("one")
    with through.stream("GET", "/v1/events", params={"after": 0}, headers={"Accept": "text/event-stream"}) as events:
        first = next(line for line in events.iter_lines() if line.startswith("event:"))
    assert first == "event: inspection.queued"


@pytest.mark.browser
@pytest.mark.tool("nginx")
@pytest.mark.tool("chromium-headless-shell")
def test_below_a_prefix_a_browser_signs_in_sends_and_reads(place: Deployment, tmp_path: Path) -> None:
    """By the name of the page; what leads past the prefix is a 404 of the proxy, which the test would see."""
    sync_api = pytest.importorskip("playwright.sync_api")
    port = free_port()
    key = Keys(place.db).create("through the proxy")[1]
    process = place.start("serve", "--port", str(port), "--workers", "1", "--root-path", PREFIX)
    wait_for(lambda: process.poll() is not None or _answers(f"http://127.0.0.1:{port}"))
    video = tmp_path / "one.mp4"
    video.write_bytes((ROOT / "samples/turbine.mp4").read_bytes())
    with proxied(tmp_path / "nginx", port, below_prefix=True) as proxy, sync_api.sync_playwright() as playwright:
        with client_of(proxy, key) as client:
            bare = client.get(proxy.url)
            assert bare.status_code == 301
            assert bare.headers["Location"].endswith(f"{PREFIX}/"), "relative addresses need it"
        browser = playwright.chromium.launch(
            executable_path=shutil.which("chromium-headless-shell"),
            args=["--no-sandbox", f"--host-resolver-rules=MAP {NAME} 127.0.0.1:{proxy.port}"],
        )
        try:
            tab = browser.new_context(ignore_https_errors=True).new_page()
            failed: list[str] = []
            asked: list[str] = []
            tab.on("response", lambda answer: failed.append(answer.url) if answer.status in (404, 500) else None)
            tab.on("request", lambda request: asked.append(request.url))
            tab.goto(f"https://{NAME}{PREFIX}/", timeout=60_000)
            tab.fill("#key", key)
            tab.click("#sign-in button")
            tab.set_input_files("#files", str(video))
            tab.click("#send:enabled")
            tab.wait_for_selector("#list li")
            tab.goto(f"https://{NAME}{PREFIX}/docs")
            tab.wait_for_selector(".opblock")
            cookies = tab.context.cookies()
        finally:
            browser.close()
    assert [cookie["path"] for cookie in cookies] == [PREFIX]
    assert failed == []
    own = [url for url in asked if url.startswith("https:")]
    assert all(url.startswith(f"https://{NAME}{PREFIX}") for url in own), own
    assert any("/v1/uploads/" in url for url in own)
