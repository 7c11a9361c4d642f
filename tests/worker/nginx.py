"""nginx as the handbook has it, in front of a server of a test."""

from __future__ import annotations

import os
import re
import socket
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from bench.soak.servers import free_port
from tests.waiting import wait_for
from tests.worker.deployment import ROOT

NAME = "inspections.example.com"
PREFIX = "/blades"


@dataclass(frozen=True)
class Proxy:
    """A running one."""

    url: str
    """By its address, with the prefix where it takes one off."""
    port: int
    authority: Path
    """The certificate that clients are to trust."""


@contextmanager
def proxied(folder: Path, server_port: int, *, below_prefix: bool = False) -> Iterator[Proxy]:
    """Start nginx with the file of the page, in a new folder, before the server at this port."""
    folder.mkdir()
    port = free_port()
    path = _configuration(folder, port, server_port, below_prefix=below_prefix)
    with (folder / "said").open("wb") as said:
        nginx = subprocess.Popen(["nginx", "-p", str(folder), "-c", str(path)], stdout=said, stderr=said)
    try:
        wait_for(lambda: nginx.poll() is not None or _accepts(port))
        assert nginx.poll() is None, (folder / "said").read_text()
        yield Proxy(f"https://127.0.0.1:{port}{PREFIX if below_prefix else ''}", port, folder / "cert.pem")
    finally:
        nginx.terminate()
        nginx.wait(10)


def _certificate(folder: Path) -> tuple[Path, Path]:
    key, pem = folder / "key.pem", folder / "cert.pem"
    command = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "2", "-subj", f"/CN={NAME}"]
    command += ["-addext", f"subjectAltName=DNS:{NAME},IP:127.0.0.1", "-keyout", str(key), "-out", str(pem)]
    subprocess.run(command, check=True, capture_output=True)
    return pem, key


def _block(page: str, name: str) -> str:
    found = re.search(rf"<!-- {name} -->\n```nginx\n(.*?)\n```\n<!-- end -->", page, re.DOTALL)
    assert found, name
    return found[1]


def _configuration(folder: Path, port: int, server_port: int, *, below_prefix: bool) -> Path:
    """The blocks of the page, with this machine's names and paths."""
    page = (ROOT / "docs" / "operations" / "reverse-proxy.md").read_text(encoding="utf-8")
    pem, key = _certificate(folder)
    text = _block(page, "nginx.conf")
    prefix = _block(page, "prefix.conf").splitlines()
    places = dict(zip(("        location / {", "            proxy_pass http://bladeatlas;"), prefix, strict=True))
    for old, new in (
        *(places.items() if below_prefix else ()),
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


def _accepts(port: int) -> bool:
    with socket.socket() as one:
        return one.connect_ex(("127.0.0.1", port)) == 0
