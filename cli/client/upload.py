"""Sending a file with tus 1.0.0, a piece in memory at a time, on from where an earlier call was cut off."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from pathlib import Path

import httpx

from cli.client.errors import raise_problem
from cli.client.retry import Transfer
from cli.client.transfers import OnBytes, Transfers
from core.errors import ResourceError
from core.files import require_file

_TUS = {"Tus-Resumable": "1.0.0"}
_PIECE = 1 << 20
_PASSING = (409, 423, 503)
"""Answers that another look at the offset may mend."""


def upload_file(http: httpx.Client, server: str, path: Path, transfers: Transfers, on_bytes: OnBytes) -> str:
    """Send a file; returns the upload's id.

    Raises:
        BadInput: the file is missing or empty, or the server does not take it.
        ResourceError: the server stays away; the next call goes on from there.
    """
    size = require_file(path, "input")
    transfer, reached = Transfer("upload", path.name), -1

    def go_on() -> str:
        nonlocal reached
        while True:
            url = _known(http, server, path, transfers) or _created(http, server, path, size, transfers)
            offset = _offset(http, url)
            if offset > reached:
                transfer.moved()
                reached = offset
            if offset == size:
                return url.rsplit("/", 1)[-1]
            _send(http, url, path, offset, size, on_bytes)

    return transfer.run(go_on)


def _known(http: httpx.Client, server: str, path: Path, transfers: Transfers) -> str | None:
    """An earlier call's upload of this file, unless the server has removed it."""
    url = transfers.find(server, path)
    if url is None:
        return None
    response = http.head(url, headers=_TUS)
    if response.status_code in (404, 410):
        transfers.remove(server, path)
        return None
    raise_problem(response)
    return url


def _created(http: httpx.Client, server: str, path: Path, size: int, transfers: Transfers) -> str:
    name = base64.b64encode(path.name.encode()).decode()
    headers = {**_TUS, "Upload-Length": str(size), "Upload-Metadata": f"filename {name}"}
    response = http.post("/v1/uploads", headers=headers)
    raise_problem(response)
    url = str(response.url.join(response.headers["Location"]))  # whatever prefix the server is behind
    transfers.keep(server, path, url)
    return url


def _offset(http: httpx.Client, url: str) -> int:
    response = http.head(url, headers=_TUS)
    raise_problem(response)
    return int(response.headers["Upload-Offset"])


def _send(http: httpx.Client, url: str, path: Path, offset: int, size: int, on_bytes: OnBytes) -> None:
    headers = {
        **_TUS,
        "Content-Type": "application/offset+octet-stream",
        "Upload-Offset": str(offset),
        "Content-Length": str(size - offset),
    }
    response = http.patch(url, content=_pieces(path, offset, size, on_bytes), headers=headers)
    if response.status_code in _PASSING:
        raise ResourceError(f"the server answered {response.status_code}", code="upload_busy")
    raise_problem(response)


def _pieces(path: Path, offset: int, size: int, on_bytes: OnBytes) -> Iterator[bytes]:
    on_bytes(path.name, offset, size)
    with path.open("rb") as stream:
        stream.seek(offset)
        while piece := stream.read(_PIECE):
            yield piece
            offset += len(piece)
            on_bytes(path.name, offset, size)
