"""Clients that generators make of the description run the walk-through: with a key, through TLS, below a prefix.

Their code and the generators' settings are those of the page for users, word for word.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import httpx
import pytest

from bench.soak.servers import free_port
from store.db import open_sqlite
from store.keys import Keys
from tests.conftest import found_program
from tests.waiting import wait_for
from tests.web.test_bundle import UNREACHED
from tests.worker.deployment import ROOT, Deployment
from tests.worker.nginx import PREFIX, proxied

pytestmark = [pytest.mark.deployment, pytest.mark.long, pytest.mark.tool("nginx")]
_PAGE = ROOT / "docs" / "how-to" / "clients.md"
_NODE = ROOT / "web" / "clients"


@dataclass(frozen=True)
class Service:
    """A server behind a proxy, and what its clients are told of it."""

    environment: Mapping[str, str]
    description: bytes


@pytest.fixture(scope="module")
def service(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Service]:
    root = tmp_path_factory.mktemp("service")
    database = open_sqlite(root / "bladeatlas.db")
    # A slow machine may look into a form for longer than other tests let files lie.
    settings = {"BLADEATLAS_GRAPH": "bench.soak.toy:GRAPH", "BLADEATLAS_STALE_S": "600"}
    place = Deployment(root, database, settings)
    key, port = Keys(database).create("a made client")[1], free_port()
    try:
        server = place.start("serve", "--port", str(port), "--workers", "2", "--root-path", PREFIX)
        wait_for(lambda: server.poll() is not None or _answers(port), 60)
        with proxied(root / "nginx", port, below_prefix=True) as proxy:
            environment = {"SERVER": proxy.url, "BLADEATLAS_API_KEY": key}
            trust = {"SSL_CERT_FILE": str(proxy.authority), "NODE_EXTRA_CA_CERTS": str(proxy.authority)}
            description = httpx.get(f"http://127.0.0.1:{port}/openapi.json", timeout=60).raise_for_status().content
            yield Service({**os.environ, **environment, **trust}, description)
    finally:
        place.stop()
        database.close()


def _answers(port: int) -> bool:
    try:
        return httpx.get(f"http://127.0.0.1:{port}/readyz").is_success
    except httpx.TransportError:
        return False


def block(name: str) -> str:
    """A file of the page."""
    text = _PAGE.read_text(encoding="utf-8")
    found = re.search(rf"<!-- {name} -->\n```\w+\n(.*?)```\n<!-- end -->", text, re.DOTALL)
    assert found is not None, name
    return found[1]


def run(command: list[str | Path], folder: Path, environment: Mapping[str, str] = os.environ) -> str:
    done = subprocess.run(
        command, cwd=folder, env=dict(environment), capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def fetched(folder: Path) -> dict[str, int]:
    """Sizes of what a client fetched."""
    root = folder / "fetched"
    return {path.relative_to(root).as_posix(): path.stat().st_size for path in root.rglob("*") if path.is_file()}


@pytest.fixture
def folder(tmp_path: Path, service: Service) -> Path:
    (tmp_path / "openapi.json").write_bytes(service.description)
    (tmp_path / "samples").symlink_to(ROOT / "samples")
    return tmp_path


@pytest.mark.tool("openapi-python-client")
def test_a_client_in_python(service: Service, folder: Path) -> None:
    (folder / "client.yaml").write_text(block("client.yaml"))
    (folder / "client.py").write_text(block("client.py"))
    generator = found_program("openapi-python-client")
    assert generator is not None
    options = ["--path", "openapi.json", "--config", "client.yaml", "--meta", "none"]
    said = run([generator, "generate", *options, "--output-path", "bladeatlas_client"], folder)
    assert "WARNING" not in said, "the generator understands the whole description"
    state, events = run([sys.executable, "client.py"], folder, service.environment).splitlines()
    assert (state, events) == ("succeeded", "0 events")
    assert fetched(folder)["sparse/points3D.bin"] == 64_000


@pytest.mark.long  # packages from npm, and a compiler
@pytest.mark.tool("npm")
def test_a_client_in_typescript(service: Service, folder: Path) -> None:
    for name in ("package.json", "package-lock.json", "tsconfig.json"):
        shutil.copy(_NODE / name, folder)
    (folder / "client.ts").write_text(block("client.ts"))
    environment = {**service.environment, "PATH": f"{Path(found_program('npm') or '').parent}:{os.environ['PATH']}"}
    (folder / "node_modules").symlink_to(_packages(environment))
    run(["npx", "openapi-typescript", "openapi.json", "-o", "bladeatlas.d.ts"], folder, environment)
    run(["npx", "tsc", "--strict"], folder, environment)
    assert run(["node", "client.js"], folder, environment).split() == ["succeeded"]
    assert fetched(folder)["sparse/points3D.bin"] == 64_000
    assert (folder / "timeline.csv").read_text().startswith("event_id,")


def _packages(environment: Mapping[str, str]) -> Path:
    """What the lock beside the page's needs names, installed once."""
    stamp, lock = _NODE / "node_modules" / ".lock-stamp", (_NODE / "package-lock.json").read_text()
    if not stamp.is_file() or stamp.read_text() != lock:
        command = ["npm", "ci", "--no-fund", "--no-audit", "--loglevel=error"]
        told = {name: value for name, value in environment.items() if name != "NODE_EXTRA_CA_CERTS"}
        done = subprocess.run(command, cwd=_NODE, env=told, capture_output=True, text=True, timeout=300, check=False)
        if done.returncode and any(code in done.stderr for code in UNREACHED):
            pytest.skip("no registry of packages can be reached")
        assert done.returncode == 0, done.stderr
        stamp.write_text(lock)
    return stamp.parent
