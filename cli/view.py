"""`bladeatlas view`: open the page of a result in the browser, served on this machine alone."""

from __future__ import annotations

import argparse
import webbrowser
from collections.abc import Sequence
from functools import partial
from http import HTTPStatus
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from cli.terminal import say
from core.errors import BadInput
from core.outputs import SUMMARY, VIEWER_PAGE, is_of_page
from core.viewer.policy import POLICY

_HOST = "127.0.0.1"
_NAMES = (_HOST, "localhost")


def command(parsed: argparse.Namespace) -> int:
    """Serve the pages of a result until interrupted; a result without any gets them first."""
    result: Path = parsed.result
    require_pages(result, parsed.video)
    with page_server(result, parsed.port) as server:
        address = f"http://{_HOST}:{server.server_port}/{VIEWER_PAGE}"
        say(f"{address}  (stop with Ctrl+C)")
        if parsed.browser and not webbrowser.open(address):
            say("no browser could be opened: open the address by hand", error=True)
        server.serve_forever()
    return 0


def require_pages(result: Path, videos: Sequence[Path]) -> None:
    """Build the pages of a result unless they are there.

    Raises:
        BadInput: it is no finished result, or lacks what a page is made of.
    """
    if not (result / SUMMARY).is_file():
        raise BadInput(f"'{result}' has no {SUMMARY}: is it a finished result?", where="RESULT")
    if (result / VIEWER_PAGE).is_file() and not videos:
        return
    # Loaded here: building needs the vision libraries, serving does not.
    from core.viewer.published import build_pages

    say("building the page from the result's files")
    try:
        lacks = build_pages(result, videos)
    except OSError as error:
        raise BadInput(f"the page cannot be written into '{result}': {error.strerror}", where="RESULT") from None
    for text in lacks:
        say(f"note: {text}")


def page_server(result: Path, port: int = 0) -> ThreadingHTTPServer:
    """A server of the pages of a result, bound to the loopback address; port 0 takes a free one.

    Raises:
        BadInput: the port is taken.
    """
    try:
        return ThreadingHTTPServer((_HOST, port), partial(_Handler, directory=str(result.resolve())))
    except (OSError, OverflowError) as error:
        raise BadInput(f"port {port} cannot be used: {error}", where="--port") from None


class _Handler(SimpleHTTPRequestHandler):
    """Files of the pages, and nothing else that lies in the result."""

    server_version, sys_version = "BladeAtlas", ""
    extensions_map = {  # noqa: RUF012 - the base class declares it so
        ".html": "text/html; charset=utf-8",
        ".js": "text/javascript; charset=utf-8",
        ".css": "text/css; charset=utf-8",
        ".json": "application/json",
        ".glb": "model/gltf-binary",
        ".jpg": "image/jpeg",
        "": "application/octet-stream",
    }

    def send_head(self) -> Any:  # the base class gives an open file or None
        """Refuse what is no page before a file is looked for."""
        if not self._from_here():
            self.send_error(HTTPStatus.MISDIRECTED_REQUEST, "this address is not served here")
            return None
        path = unquote(urlsplit(self.path).path)
        if path == "/":
            self.send_response(HTTPStatus.FOUND)
            self.send_header("Location", f"/{VIEWER_PAGE}")
            self.send_header("Content-Length", "0")
            self.end_headers()
            return None
        if not _is_of_a_page(path) or not self._is_own_file(path):
            self.send_error(HTTPStatus.NOT_FOUND)
            return None
        return super().send_head()

    def end_headers(self) -> None:
        """Every answer has the page's policy; a page that was built anew is seen at once."""
        self.send_header("Content-Security-Policy", POLICY)
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("Referrer-Policy", "no-referrer")
        self.send_header("Cache-Control", "no-cache")
        super().end_headers()

    def log_message(self, format: str, *args: object) -> None:
        """Say nothing: the terminal belongs to the command."""

    def _from_here(self) -> bool:
        """Whether the browser means this machine: another site's name that points here is refused."""
        name = self.headers.get("Host", "").rpartition(":")[0] or self.headers.get("Host", "")
        return name in _NAMES

    def _is_own_file(self, path: str) -> bool:
        """Whether it is a file of the result, also behind links."""
        root = Path(self.directory)
        file = (root / path.lstrip("/")).resolve()
        return file.is_file() and file.is_relative_to(root)


def _is_of_a_page(path: str) -> bool:
    """Whether a path is that of a file of a page: below ``viewer/`` or ``models/N/viewer/``, nothing hidden."""
    parts = path.strip("/").split("/")
    if any(not part or part.startswith(".") or "\\" in part or "\0" in part for part in parts):
        return False
    return is_of_page(path.strip("/")) and not path.endswith("/")
