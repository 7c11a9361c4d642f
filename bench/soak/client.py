"""A client that never gives up: resumes uploads and downloads, repeats requests, checks every hash."""

from __future__ import annotations

import hashlib
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, TypeVar

import httpx
from tenacity import Retrying, retry_if_exception, stop_after_delay, wait_fixed

from core.states import InspectionState

T = TypeVar("T")
_AWAY_S = 120.0
_PAUSE_S = 0.3
_CHUNK = 16 << 10
_TUS = {"Tus-Resumable": "1.0.0"}
OVER = (InspectionState.SUCCEEDED, InspectionState.PARTIAL, InspectionState.FAILED, InspectionState.CANCELLED)


class SoakClient:
    """Speaks the HTTP API of one server that may be away at any moment."""

    def __init__(self, url: str, on_transfer: Callable[[str], None] = lambda _kind: None) -> None:
        """`on_transfer` is called in the middle of every ``upload`` and ``download``, with which of them it is."""
        self._http = httpx.Client(base_url=url, timeout=10.0)
        self._on_transfer = on_transfer

    def submit(self, name: str, video: Path, annotations: Path, parameters: dict[str, Any]) -> str:
        """Upload both files resumably and create an inspection; returns its id."""
        body = {
            "video_upload": self._upload(video),
            "annotations_upload": self._upload(annotations),
            "parameters": {**parameters, "external_id": name},
        }
        made = self._send(lambda: self._http.post("/v1/inspections", json=body, headers={"Idempotency-Key": name}))
        return str(made.json()["id"])

    def resource(self, inspection_id: str) -> dict[str, Any]:
        """The inspection as it stands."""
        found: dict[str, Any] = self._send(lambda: self._http.get(f"/v1/inspections/{inspection_id}")).json()
        return found

    def wait(self, inspection_id: str, seconds: float) -> dict[str, Any]:
        """The inspection once it is over; `TimeoutError` when it is not in time."""
        deadline = time.monotonic() + seconds
        while (found := self.resource(inspection_id))["state"] not in OVER:
            if time.monotonic() > deadline:
                raise TimeoutError(f"inspection {inspection_id} is still {found['state']}")
            time.sleep(_PAUSE_S)
        return found

    def download(self, inspection_id: str, folder: Path) -> list[str]:
        """Fetch every artifact, going on after every cut; returns paths whose hash is wrong."""
        listed = self._send(lambda: self._http.get(f"/v1/inspections/{inspection_id}/artifacts")).json()["artifacts"]
        wrong = []
        for item in listed:
            target = folder / item["path"]
            target.parent.mkdir(parents=True, exist_ok=True)
            target.unlink(missing_ok=True)
            _retried(lambda item=item, target=target: self._fetch(item, target))  # type: ignore[misc]
            if hashlib.sha256(target.read_bytes()).hexdigest() != item["sha256"]:
                wrong.append(str(item["path"]))
        return wrong

    def _fetch(self, item: dict[str, Any], target: Path) -> bool:
        have = target.stat().st_size if target.exists() else 0
        if have and have >= item["size"]:
            return True
        headers = {"Range": f"bytes={have}-", "If-Range": f'"{item["sha256"]}"'} if have else {}
        with self._http.stream("GET", item["link"], headers=headers) as answer:
            answer.raise_for_status()
            with target.open("ab" if answer.status_code == httpx.codes.PARTIAL_CONTENT else "wb") as write:
                for chunk in answer.iter_bytes(_CHUNK):
                    write.write(chunk)
                    if target.stat().st_size < item["size"]:
                        self._on_transfer("download")
        return True

    def _upload(self, path: Path) -> str:
        data = path.read_bytes()
        headers = {**_TUS, "Upload-Length": str(len(data))}
        made = self._send(lambda: self._http.post("/v1/uploads", headers=headers))
        location = made.headers["Location"]
        _retried(lambda: self._go_on(location, data))
        return str(location).rsplit("/", 1)[-1]

    def _go_on(self, location: str, data: bytes) -> bool:
        """Send the rest of an upload, from wherever the server has got to."""
        head = self._http.head(location, headers=_TUS)
        head.raise_for_status()
        offset = int(head.headers["Upload-Offset"])
        if offset < len(data):
            headers = {
                **_TUS,
                "Upload-Offset": str(offset),
                "Content-Type": "application/offset+octet-stream",
                "Content-Length": str(len(data) - offset),
            }
            self._http.patch(location, headers=headers, content=self._rest(data, offset)).raise_for_status()
        return True

    def _rest(self, data: bytes, offset: int) -> Iterator[bytes]:
        middle = (offset + len(data)) // 2
        yield data[offset:middle]
        self._on_transfer("upload")
        yield data[middle:]

    def _send(self, request: Callable[[], httpx.Response]) -> httpx.Response:
        def checked() -> httpx.Response:
            return request().raise_for_status()

        return _retried(checked)


def _retried(call: Callable[[], T]) -> T:
    """Repeat what a server that is away, busy or restarting did not answer."""
    policy = Retrying(
        retry=retry_if_exception(_may_pass), wait=wait_fixed(_PAUSE_S), stop=stop_after_delay(_AWAY_S), reraise=True
    )
    return policy(call)


def _may_pass(error: BaseException) -> bool:
    if isinstance(error, httpx.HTTPStatusError):
        status = error.response.status_code
        return status >= httpx.codes.INTERNAL_SERVER_ERROR or status in (409, 423, 429)
    return isinstance(error, httpx.TransportError)
