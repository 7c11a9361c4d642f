"""The server as strangers reach it: through the proxy of the handbook, and with more connections than descriptors."""

from __future__ import annotations

import os
import re
import resource
import socket
import ssl
import subprocess
import time
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import httpx
import psutil
import pytest

from store.db import open_sqlite
from store.keys import Keys
from tests.waiting import wait_for
from tests.worker.deployment import ROOT, Deployment
from tests.worker.test_serve import _answers, free_port

pytestmark = pytest.mark.deployment
_NAME = "inspections.example.com"
_TUS = {"Tus-Resumable": "1.0.0"}


@pytest.fixture
def place(tmp_path: Path) -> Iterator[Deployment]:
    database = open_sqlite(tmp_path / "bladeatlas.db")
    made = Deployment(tmp_path, database, {"BLADEATLAS_TRUSTED_HOSTS": _NAME, "BLADEATLAS_HEADER_SECONDS": "600"})
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


def certificate(folder: Path) -> tuple[Path, Path]:
    key, pem = folder / "key.pem", folder / "cert.pem"
    command = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", f"/CN={_NAME}"]
    command += ["-addext", f"subjectAltName=DNS:{_NAME}", "-keyout", str(key), "-out", str(pem)]
    subprocess.run(command, check=True, capture_output=True)
    return pem, key


def configuration(folder: Path, port: int, server_port: int) -> Path:
    """The block of the page, with this machine's names and paths."""
    page = (ROOT / "docs" / "operations" / "reverse-proxy.md").read_text(encoding="utf-8")
    found = re.search(r"<!-- nginx.conf -->\n```nginx\n(.*?)\n```\n<!-- end -->", page, re.DOTALL)
    assert found
    pem, key = certificate(folder)
    text = found[1]
    for old, new in (
        ("/etc/ssl/inspections.pem", str(pem)),
        ("/etc/ssl/inspections.key", str(key)),
        ("listen 443 ssl", f"listen 127.0.0.1:{port} ssl"),
        ("127.0.0.1:8000", f"127.0.0.1:{server_port}"),
    ):
        assert text.count(old) == 1, old
        text = text.replace(old, new)
    path = folder / "nginx.conf"
    folders = ("client_body", "proxy", "fastcgi", "uwsgi", "scgi")
    temporary = "".join(f"    {name}_temp_path {folder}/{name};\n" for name in folders)
    own = f"daemon off;\npid {folder}/nginx.pid;\n"
    user = "user root;\n" if os.getuid() == 0 else ""  # the test's folder is this user's alone
    path.write_text(own + user + text.replace("http {\n", "http {\n" + temporary, 1), encoding="utf-8")
    return path


@pytest.fixture
def proxied(place: Deployment, tmp_path: Path) -> Iterator[httpx.Client]:
    port, server_port = free_port(), free_port()
    key = Keys(place.db).create("through the proxy")[1]
    start(place, server_port)
    folder = tmp_path / "nginx"
    folder.mkdir()
    path = configuration(folder, port, server_port)
    with (folder / "said").open("wb") as said:
        nginx = subprocess.Popen(["nginx", "-p", str(folder), "-c", str(path)], stdout=said, stderr=said)
    headers = {"Host": _NAME, "Authorization": f"Bearer {key}"}
    try:
        trust = ssl.create_default_context(cafile=str(folder / "cert.pem"))
        trust.check_hostname = False  # it is asked by its address
        with httpx.Client(base_url=f"https://127.0.0.1:{port}", headers=headers, verify=trust, timeout=30) as client:
            wait_for(lambda: nginx.poll() is not None or _accepts(port))
            assert nginx.poll() is None, (folder / "said").read_text()
            yield client
    finally:
        nginx.terminate()
        nginx.wait(10)


def _accepts(port: int) -> bool:
    with socket.socket() as one:
        return one.connect_ex(("127.0.0.1", port)) == 0


@pytest.mark.tool("nginx")
def test_the_proxy_of_the_handbook_passes_everything_on(place: Deployment, proxied: httpx.Client) -> None:
    assert proxied.get("/v1/limits").status_code == 200
    assert proxied.get("/v1/limits", headers={"Authorization": ""}).status_code == 401, (
        "it is no caller of this machine"
    )
    assert proxied.get("/v1/limits", headers={"Host": "elsewhere.example.com"}).status_code == 421
    session = proxied.post("/v1/session")
    assert "Secure" in session.headers["Set-Cookie"], "the server knows that TLS is before it"

    # Larger than any buffer, and its first part is on disk while the rest is still to come.
    made = proxied.post("/v1/uploads", headers={**_TUS, "Upload-Length": str(8 << 20)})
    url = made.headers["Location"]
    seen: list[int] = []

    def parts() -> Iterator[bytes]:
        yield bytes(6 << 20)
        wait_for(lambda: bool(next((place.root / "uploads").iterdir()).stat().st_size))
        seen.append(next((place.root / "uploads").iterdir()).stat().st_size)
        yield bytes(2 << 20)

    headers = {**_TUS, "Upload-Offset": "0", "Content-Type": "application/offset+octet-stream"}
    assert proxied.patch(url, content=parts(), headers=headers).headers["Upload-Offset"] == str(8 << 20)
    assert seen[0] > 0

    place.create("one")
    place.wait("one")
    with proxied.stream("GET", "/v1/events", params={"after": 0}, headers={"Accept": "text/event-stream"}) as events:
        first = next(line for line in events.iter_lines() if line.startswith("event:"))
    assert first == "event: inspection.queued"
