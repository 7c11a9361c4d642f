"""Fetching a file: on from where it was cut off, and under its name only when its hash is right."""

from __future__ import annotations

from pathlib import Path, PurePosixPath
from urllib.parse import quote

import httpx

from cli.client.errors import raise_problem
from cli.client.retry import Transfer
from cli.client.transfers import OnBytes
from cli.client.values import ArtifactInfo
from core.errors import BadInput, ResourceError
from core.fingerprint import digest_of_file

_CHUNK = 1 << 20


def download_file(http: httpx.Client, base: str, artifact: ArtifactInfo, out: Path, on_bytes: OnBytes) -> Path:
    """Fetch one file below `out`; one that is there with the right content is left alone.

    Raises:
        BadInput: its name leads out of the folder, or there is no such file.
        ResourceError: the server stays away, or sends something else.
    """
    final = _inside(out, artifact.path)
    if final.is_file() and final.stat().st_size == artifact.size and digest_of_file(final) == artifact.sha256:
        on_bytes(artifact.path, artifact.size, artifact.size)
        return final
    final.parent.mkdir(parents=True, exist_ok=True)
    part = final.with_name(f".{final.name}.{artifact.sha256[:16]}.part")
    transfer = Transfer("download", artifact.path)

    def go_on() -> None:
        while (before := _size(part)) < artifact.size or not part.is_file():
            try:
                _fetch(http, f"{base}/artifacts/{quote(artifact.path)}", artifact, part, on_bytes)
            finally:
                if _size(part) > before:
                    transfer.moved()

    transfer.run(go_on)
    if digest_of_file(part) != artifact.sha256:
        part.unlink()
        raise ResourceError(f"'{artifact.path}' arrived damaged", code="damaged_download")
    part.replace(final)
    return final


def _size(part: Path) -> int:
    return part.stat().st_size if part.is_file() else 0


def _fetch(http: httpx.Client, url: str, artifact: ArtifactInfo, part: Path, on_bytes: OnBytes) -> None:
    done = _size(part)
    # As it is: its length is known then, and a part that came belongs to what a later request goes on with.
    headers = {"Accept-Encoding": "identity"}
    if done:
        headers |= {"Range": f"bytes={done}-", "If-Range": f'"{artifact.sha256}"'}
    with http.stream("GET", url, headers=headers) as response:
        if response.status_code >= 400:
            response.read()
            raise_problem(response)
        if response.status_code != httpx.codes.PARTIAL_CONTENT:
            done = 0
        with part.open("r+b" if done else "wb") as stream:
            stream.seek(done)
            for chunk in response.iter_bytes(_CHUNK):
                stream.write(chunk)
                done += len(chunk)
                on_bytes(artifact.path, done, artifact.size)


def _inside(out: Path, path: str) -> Path:
    """The file's place below the folder; a server must not choose any other."""
    parts = PurePosixPath(path)
    if parts.is_absolute() or ".." in parts.parts or not parts.parts:
        raise BadInput(f"the server names a file '{path}' that lies outside the folder", where="--out")
    return out.joinpath(*parts.parts)
