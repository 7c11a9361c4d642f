"""A server that may fetch inputs by URL, and what came of what it was asked."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from ipaddress import ip_network
from typing import Any

import httpx
from fastapi import FastAPI
from sqlalchemy import select

from api.app import create_app
from store.downloads import AllowedHosts, Downloads
from store.leasing import input_files
from store.models import Inspection, Upload
from store.outbound import Outbound
from tests.api.conftest import Backend
from tests.api.file_server import HERE, Files


@dataclass
class Place:
    """A server that may fetch from `files`."""

    backend: Backend
    app: FastAPI
    address: str
    looked_up: list[str] = field(default_factory=list)
    leads_to: Callable[[str, int], list[str]] = lambda host, times: [HERE if host == "files.test" else "127.0.0.1"]
    """Addresses of a name at the so many-th look-up."""

    def look_up(self, host: str, port: int) -> list[str]:
        self.looked_up.append(host)
        return self.leads_to(host, len(self.looked_up))

    def post(self, **body: Any) -> httpx.Response:
        return httpx.post(f"{self.address}/v1/inspections", json=body, timeout=60)

    def post_until(self, **body: Any) -> httpx.Response:
        """As a client does that is told to come back."""
        while True:
            answer = self.post(**body)
            if answer.status_code != 409:
                return answer
            assert (answer.json()["code"], answer.json()["retryable"]) == ("fetching", True)
            assert answer.headers["Retry-After"] == "5"
            time.sleep(0.1)


def make_place(backend: Backend, files: Files, serve: Callable[[FastAPI], str], **settings: Any) -> Place:
    app = create_app(backend.with_settings(**settings).services)
    place = Place(backend, app, serve(app))
    hosts = AllowedHosts.parse(f"files.test:{files.port}, inside.test:{files.port}")
    outbound = Outbound([ip_network(f"{HERE}/32")], place.look_up)
    app.state.bladeatlas.fetches.fetcher.downloads = Downloads(outbound, hosts, sleep=lambda _: None)
    return place


def kept(place: Place, answer: httpx.Response) -> list[bytes]:
    """The inputs of an inspection, as they lie in the store."""
    with place.backend.db.read() as session:
        row = session.get_one(Inspection, answer.json()["id"])
        keys = [key for one in input_files(row) for key in (one.video, one.annotations) if key]
    folder = place.backend.services.artifacts.folder
    assert folder is not None
    return [(folder / key).read_bytes() for key in keys]


def uploads_left(place: Place) -> int:
    with place.backend.db.read() as session:
        return len(session.scalars(select(Upload).where(Upload.removed_at.is_(None))).all())


def refused(answer: httpx.Response) -> tuple[int, str, str]:
    problem = answer.json()
    return answer.status_code, problem["code"], problem["errors"][0]["pointer"]
