"""The service's calls as methods. Whatever can be sent again safely is, when the network fails."""

from __future__ import annotations

import uuid
from collections.abc import Callable, Iterator, Mapping, Sequence
from fnmatch import fnmatchcase
from pathlib import Path
from types import TracebackType
from typing import Any, Self

import httpx

from cli.client.download import download_file
from cli.client.errors import raise_problem
from cli.client.retry import sent_again
from cli.client.transfers import OnBytes, Transfers, no_progress
from cli.client.upload import upload_file
from cli.client.values import ArtifactInfo, InspectionInfo
from core.errors import BadInput
from core.videos import Recording

_LONG_POLL_S = 30
_TIMEOUT = httpx.Timeout(60.0, connect=10.0)


class Client:
    """A server, and who asks it; use as a context manager.

    Args:
        server: address, e.g. ``http://127.0.0.1:8000``.
        key: API key; None when the server has none.
        transfers: remembers unfinished uploads; None = beside the user's caches.
    """

    def __init__(self, server: str, key: str | None = None, *, transfers: Transfers | None = None) -> None:
        headers = {"Authorization": f"Bearer {key}"} if key else {}
        try:
            self._http = httpx.Client(base_url=server.rstrip("/"), headers=headers, timeout=_TIMEOUT)
        except httpx.InvalidURL as error:
            raise BadInput(f"'{server}' is no address: {error}", where="--server") from None
        self._server = server.rstrip("/")
        self._transfers = transfers or Transfers()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._http.close()

    def upload(self, path: Path, on_bytes: OnBytes = no_progress) -> str:
        """Send a file, or the rest of it when an earlier call was cut off; returns the upload's id."""
        return upload_file(self._http, self._server, path, self._transfers, on_bytes)

    def submit(
        self,
        video: Path,
        annotations: Path | None = None,
        parameters: Mapping[str, Any] | None = None,
        *,
        further: Sequence[Recording] = (),
        idempotency_key: str | None = None,
        on_bytes: OnBytes = no_progress,
    ) -> InspectionInfo:
        """Upload the files and start an inspection; one inspection, however often the network fails.

        `further` are videos of the same inspection after the first, each with its annotations.
        """
        recordings = [Recording(video, annotations), *further]
        uploads = [self._uploaded(one, on_bytes) for one in recordings]
        body: dict[str, Any] = {"parameters": dict(parameters or {})}
        body |= {"videos": uploads} if further else uploads[0]
        headers = {"Idempotency-Key": idempotency_key or uuid.uuid4().hex}
        response = self._answer(lambda: self._http.post("/v1/inspections", json=body, headers=headers))
        sent = [path for one in recordings for path in (one.video, one.annotations) if path is not None]
        self._transfers.remove(self._server, *sent)
        return _inspection(response)

    def _uploaded(self, recording: Recording, on_bytes: OnBytes) -> dict[str, str]:
        names = {"video_upload": self.upload(recording.video, on_bytes)}
        if recording.annotations is not None:
            names["annotations_upload"] = self.upload(recording.annotations, on_bytes)
        return names

    def get(self, inspection_id: str) -> InspectionInfo:
        """The inspection as it is now."""
        return _inspection(self._answer(lambda: self._http.get(f"/v1/inspections/{inspection_id}")))

    def watch(self, inspection_id: str) -> Iterator[InspectionInfo]:
        """The inspection now and after every change, until it is over."""
        seen = self.get(inspection_id)
        yield seen
        while seen.active:
            headers = {"If-None-Match": seen.etag or ""}
            url = f"/v1/inspections/{inspection_id}?wait={_LONG_POLL_S}"
            response = self._answer(lambda u=url, h=headers: self._http.get(u, headers=h))  # type: ignore[misc]
            if response.status_code != httpx.codes.NOT_MODIFIED:
                seen = _inspection(response)
                yield seen

    def wait(self, inspection_id: str) -> InspectionInfo:
        """Return once it is over."""
        *_, last = self.watch(inspection_id)
        return last

    def list(self, **filters: Any) -> Iterator[InspectionInfo]:
        """Inspections, newest first; filters are the query's, e.g. ``state``, ``label``, ``external_id``."""
        cursor: str | None = None
        while True:
            params = {**filters, **({"cursor": cursor} if cursor else {})}
            page = self._answer(lambda p=params: self._http.get("/v1/inspections", params=p)).json()  # type: ignore[misc]
            yield from (InspectionInfo.from_json(item) for item in page["inspections"])
            cursor = page["next_cursor"]
            if cursor is None:
                return

    def cancel(self, inspection_id: str) -> InspectionInfo:
        """Ask it to stop."""
        return _inspection(self._answer(lambda: self._http.post(f"/v1/inspections/{inspection_id}/cancel")))

    def retry(
        self, inspection_id: str, from_stage: str = "auto", parameters: Mapping[str, Any] | None = None
    ) -> InspectionInfo:
        """Begin its next attempt. Not sent twice: the first may have begun it."""
        body = {"from_stage": from_stage, "parameters": dict(parameters) if parameters is not None else None}
        response = self._http.post(f"/v1/inspections/{inspection_id}/retry", json=body)
        raise_problem(response)
        return _inspection(response)

    def delete(self, inspection_id: str) -> None:
        """Remove it; nothing happens when it is gone already."""
        response = sent_again(lambda: self._http.delete(f"/v1/inspections/{inspection_id}"))
        if response.status_code != httpx.codes.GONE:
            raise_problem(response)

    def table(self, inspection_id: str, name: str, **filters: Any) -> Any:
        """A table as JSON, by the last part of its path: ``cases``, ``detections``, ``timeline``, ``quality`` ..."""
        url = f"/v1/inspections/{inspection_id}/{name}"
        return self._answer(lambda: self._http.get(url, params=filters)).json()

    def artifacts(self, inspection_id: str) -> tuple[ArtifactInfo, ...]:
        """Its files."""
        listed = self._answer(lambda: self._http.get(f"/v1/inspections/{inspection_id}/artifacts")).json()
        return tuple(ArtifactInfo.from_json(item) for item in listed["artifacts"])

    def download(self, inspection_id: str, artifact: ArtifactInfo, out: Path, on_bytes: OnBytes = no_progress) -> Path:
        """Fetch one file below `out`, or the rest of it; its SHA-256 is checked before it gets its name."""
        return download_file(self._http, f"/v1/inspections/{inspection_id}", artifact, out, on_bytes)

    def _answer(self, send: Callable[[], httpx.Response]) -> httpx.Response:
        """The answer of a request that may be sent again; raises the problem that it states."""
        response = sent_again(send)
        raise_problem(response)
        return response


def chosen(artifacts: tuple[ArtifactInfo, ...], include: list[str]) -> list[ArtifactInfo]:
    """Files whose path matches a pattern; all without patterns."""
    return [a for a in artifacts if not include or any(fnmatchcase(a.path, pattern) for pattern in include)]


def _inspection(response: httpx.Response) -> InspectionInfo:
    return InspectionInfo.from_json(response.json(), response.headers.get("ETag"))
