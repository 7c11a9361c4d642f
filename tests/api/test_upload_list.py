"""What an account has sent and not used: listed, and ended by its time."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from email.utils import parsedate_to_datetime

import httpx
from fastapi.testclient import TestClient
from sqlalchemy import update

from store.housekeeping import Retention
from store.models import Upload
from tests.api.conftest import TUS, Backend
from tests.api.test_uploads import begin, patch

_BYTES = "application/offset+octet-stream"


def listed(client: TestClient, query: str = "", **more: dict[str, str]) -> list[tuple[str, str]]:
    found = client.get(f"/v1/uploads{query}", **more).json()["uploads"]
    return [(one["link"], one["state"]) for one in found]


def set_expiry(backend: Backend, url: str, **since_now: float) -> None:
    """Let an upload end so long from now."""
    with backend.db.write() as session:
        moment = backend.db.now(session) + timedelta(**since_now)
        session.execute(update(Upload).where(Upload.id == url.rsplit("/", 1)[1]).values(expires_at=moment))


def expires(answer: httpx.Response) -> datetime:
    return parsedate_to_datetime(answer.headers["Upload-Expires"])


def test_every_answer_about_an_upload_says_when_it_ends(client: TestClient) -> None:
    made = client.post("/v1/uploads", headers={**TUS, "Upload-Length": "5"})
    url = made.headers["Location"]
    hours = (expires(made) - datetime.now(UTC)).total_seconds() / 3600
    assert 71.9 < hours <= 72.0
    assert made.headers["Upload-Expires"].endswith(" GMT")
    assert expires(client.head(url, headers=TUS)) == expires(patch(client, url, 0, b"abc")) == expires(made)


def test_an_account_sees_its_uploads_newest_first(backend: Backend, client: TestClient) -> None:
    mine, others = backend.key("mine"), backend.key("others")
    urls = [begin(client, 5, **mine, **{"Upload-Metadata": "filename YS5tcDQ="}) for _ in range(3)]
    begin(client, 5, **others)
    client.patch(
        urls[1], content=b"abcde", headers={**TUS, **mine, "Upload-Offset": "0", "Content-Type": _BYTES}
    ).raise_for_status()
    client.delete(urls[0], headers={**TUS, **mine}).raise_for_status()
    assert listed(client, headers=mine) == [(urls[2], "open"), (urls[1], "finished")]
    assert listed(client, "?state=open", headers=mine) == [(urls[2], "open")]
    assert listed(client, "?state=finished", headers=mine) == [(urls[1], "finished")]
    one = client.get("/v1/uploads?state=finished", headers=mine).json()["uploads"][0]
    assert (one["length"], one["offset"], one["metadata"]) == (5, 5, {"filename": "a.mp4"})
    assert len(one["sha256"]) == 64
    assert client.get("/v1/uploads?state=ended", headers=mine).status_code == 422


def test_uploads_come_in_pages(backend: Backend, client: TestClient) -> None:
    urls = [begin(client, 5) for _ in range(5)]
    seen: list[str] = []
    address: str | None = "/v1/uploads?limit=2"
    while address is not None:
        answer = client.get(address)
        seen += [one["link"] for one in answer.json()["uploads"]]
        address = answer.links.get("next", {}).get("url")
    assert seen == urls[::-1]
    assert client.get("/v1/uploads?cursor=bm90aGluZw").json()["code"] == "bad_cursor"


def test_an_upload_ends_at_its_time_and_its_row_soon_after(backend: Backend, client: TestClient) -> None:
    url = begin(client, 5)
    set_expiry(backend, url, seconds=-1)
    assert listed(client) == []
    assert client.head(url, headers=TUS).status_code == 410, "before any cleaner came by"
    assert patch(client, url, 0, b"abc").status_code == 410
    retention = Retention(backend.db)
    assert retention.expire_uploads() == 1
    with backend.db.write() as session:
        removed = backend.db.now(session) - timedelta(days=4)
        session.execute(update(Upload).values(removed_at=removed))
    retention.tidy()
    assert client.head(url, headers=TUS).status_code == 404
