"""A local https server of files with an authority of its own, which can be told to misbehave."""

from __future__ import annotations

import ssl
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import trustme

HERE = "127.0.0.2"
"""The address that the tests allow; 127.0.0.1 stands for the inside of a network."""
DATA = bytes(range(256)) * 12_000


@dataclass
class Files:
    """A server of files that can be told to misbehave."""

    port: int = 0
    content: dict[str, bytes] = field(default_factory=lambda: {"/video": DATA, "/notes": b"[]"})
    redirects: dict[str, str] = field(default_factory=dict)
    cut_after: list[int] = field(default_factory=list)
    """Bytes after which the next answers are cut off, one after the other."""
    stops: list[threading.Event] = field(default_factory=list)
    """The next answers wait in their middle, each until its event is set."""
    tag: str = '"one"'
    status: int = 0
    says_length: bool = True
    piece_s: float = 0.0
    asked: list[tuple[str, str]] = field(default_factory=list)
    """Path and ``Range`` of every request."""

    def url(self, path: str = "/video", host: str = "files.test") -> str:
        return f"https://{host}:{self.port}{path}"


class Handler(BaseHTTPRequestHandler):
    files: Files

    def do_GET(self) -> None:
        files, wanted = self.files, self.headers.get("Range", "")
        files.asked.append((self.path, wanted))
        if self.path in files.redirects or files.status:
            self.send_response(files.status or 302)
            self.send_header("Location", files.redirects.get(self.path, ""))
            self.send_header("Content-Length", "0")
            self.end_headers()
            return
        data = files.content[self.path]
        start = int(wanted[6:-1]) if wanted and self.headers["If-Range"] == files.tag else 0
        self.send_response(206 if start else 200)
        if start:
            self.send_header("Content-Range", f"bytes {start}-{len(data) - 1}/{len(data)}")
        if files.says_length:
            self.send_header("Content-Length", str(len(data) - start))
        if files.tag:
            self.send_header("ETag", files.tag)
        self.end_headers()
        stop = files.stops.pop(0) if files.stops else None
        end = start + files.cut_after.pop(0) if files.cut_after else len(data)
        for begin in range(start, min(end, len(data)), 100_000):
            self.wfile.write(data[begin : min(begin + 100_000, end)])
            time.sleep(files.piece_s)
            if stop is not None and 2 * begin >= len(data):
                stop.wait()
        self.close_connection = True

    def log_message(self, format: str, *args: Any) -> None:
        """Tests need no lines of it."""


@cache
def _authority() -> trustme.CA:
    return trustme.CA()


@contextmanager
def files_served(certificate: Path) -> Iterator[Files]:
    """A server on `HERE`; the certificate of its authority is written, for `SSL_CERT_FILE`."""
    _authority().cert_pem.write_to_path(str(certificate))
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    _authority().issue_cert("files.test", "inside.test", HERE).configure_cert(context)
    made = Files()
    server = ThreadingHTTPServer((HERE, 0), type("Bound", (Handler,), {"files": made}))
    server.socket = context.wrap_socket(server.socket, server_side=True)
    made.port = server.server_address[1]
    thread = threading.Thread(target=server.serve_forever, daemon=True)
    thread.start()
    yield made
    server.shutdown()
    server.server_close()
    thread.join()
