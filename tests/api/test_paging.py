"""Tables in pages: every row once, all of one version, and not sent again to who has them."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from typing import Any

import httpx
import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient

from api.app import create_app
from api.problems import MEDIA_TYPE
from store import tables
from store.tables import replace_rows
from tests.api.conftest import Backend
from tests.api.test_results import ROWS, case, detection

MANY = [detection(number, label="dent" if number % 3 else "nick") for number in range(1203)]


def replace(backend: Backend, one: str, **rows: Any) -> None:
    with backend.db.write() as session:
        replace_rows(session, one, rows)


@pytest.mark.parametrize("query", ["limit=500", "limit=401&label=nick", "limit=5000"])
def test_pages_hold_every_row_once(backend: Backend, client: TestClient, query: str) -> None:
    url = f"/v1/inspections/{backend.finished('one', detections=MANY)}/detections?{query}"
    seen: list[dict[str, Any]] = []
    pages = 0
    while url:
        answer = client.get(url)
        assert answer.status_code == 200
        seen += answer.json()
        pages += 1
        url = answer.links.get("next", {}).get("url", "")
    assert seen == [row for row in MANY if "nick" not in query or row["label"] == "nick"]
    assert pages == (3 if query == "limit=500" else 1)


def test_without_a_limit_everything_comes(backend: Backend, client: TestClient) -> None:
    url = f"/v1/inspections/{backend.finished('one', detections=MANY)}/detections"
    whole = client.get(url)
    assert whole.json() == MANY
    assert "Link" not in whole.headers
    read = list(csv.DictReader(io.StringIO(client.get(f"{url}?format=csv").text, newline="")))
    assert [int(row["id"]) for row in read] == [row["id"] for row in MANY]
    page = client.get(f"{url}?limit=1000&format=csv")
    rest = client.get(page.links["next"]["url"].replace("limit=1000&format=csv&", ""))
    assert [row["id"] for row in rest.json()] == list(range(1000, 1203)), "a cursor alone: all that follows"


def test_every_table_has_pages(backend: Backend, client: TestClient) -> None:
    cases = [case(f"seg_{kind}_{number}", kind=kind) for number in range(2) for kind in ("coarse", "refine")]
    metrics = [{"name": f"fuse.{name}", "value": 1.0} for name in "abc"]
    defects = [{**ROWS["defects"][0], "id": number} for number in range(3)]
    one = backend.finished("one", **{**ROWS, "cases": cases, "metrics": metrics, "defects": defects})
    for name in ("cases", "metrics", "detections", "timeline", "defects"):
        url = f"/v1/inspections/{one}/{name}"
        first = client.get(f"{url}?limit=1")
        rest = client.get(first.links["next"]["url"].replace("limit=1", "limit=99"))
        assert first.json() + rest.json() == client.get(url).json(), name


def test_defects_are_chosen_by_their_records(backend: Backend, client: TestClient) -> None:
    record = ROWS["defects"][0]["record"]
    known = [
        {**ROWS["defects"][0], "id": 1, "record": {**record, "blade": "B7", "confidence": {"value": 0.25}}},
        {**ROWS["defects"][0], "id": 2, "record": {**record, "id": 2, "blade": None, "confidence": {"value": 0.75}}},
    ]
    url = f"/v1/inspections/{backend.finished('one', defects=known)}/defects"
    assert [row["id"] for row in client.get(f"{url}?blade=B7").json()] == [1]
    assert [row["id"] for row in client.get(f"{url}?min_confidence=0.5").json()] == [2]
    assert client.get(f"{url}?min_confidence=0.5&blade=B7").json() == []


def test_a_table_that_is_at_hand_is_not_sent_again(backend: Backend, client: TestClient) -> None:
    one = backend.finished("one", **ROWS)
    url = f"/v1/inspections/{one}/detections"
    whole = client.get(url)
    tag = {"If-None-Match": whole.headers["ETag"]}
    same = client.get(url, headers=tag)
    assert (same.status_code, same.content, same.headers["ETag"]) == (304, b"", tag["If-None-Match"])
    others = {client.get(f"{url}?{query}").headers["ETag"] for query in ("format=csv", "label=dent", "limit=1")}
    assert len({*others, tag["If-None-Match"]}) == 4, "another form or choice has another tag"
    replace(backend, one, cases=[case("seg_9")])
    assert client.get(url, headers=tag).status_code == 304, "another table changed"
    replace(backend, one, detections=ROWS["detections"][:1])
    assert len(client.get(url, headers=tag).json()) == 1
    quality = f"/v1/inspections/{backend.finished('two', {'quality.json': b'{}'})}/quality"
    for form in ("json", "csv"):
        etag = client.get(f"{quality}?format={form}").headers["ETag"]
        assert client.get(f"{quality}?format={form}", headers={"If-None-Match": etag}).status_code == 304


def test_pages_of_two_versions_are_never_mixed(backend: Backend, client: TestClient) -> None:
    one = backend.finished("one", detections=MANY)
    following = client.get(f"/v1/inspections/{one}/detections?limit=10").links["next"]["url"]
    replace(backend, one, detections=MANY[::-1])
    answer = client.get(following)
    assert (answer.status_code, answer.json()["code"]) == (409, "table_changed")
    assert answer.headers["content-type"] == MEDIA_TYPE


@pytest.mark.parametrize("form", ["json", "csv"])
def test_an_answer_whose_rows_are_replaced_is_cut_off(
    backend: Backend, serve: Callable[[FastAPI], str], monkeypatch: pytest.MonkeyPatch, form: str
) -> None:
    one = backend.finished("one", detections=MANY)
    read, pages = tables.read_page, 0

    def replaced_meanwhile(*arguments: Any) -> Any:
        nonlocal pages
        pages += 1
        if pages == 2:
            replace(backend, one, detections=MANY)
        return read(*arguments)

    monkeypatch.setattr("api.paging.read_page", replaced_meanwhile)
    url = f"{serve(create_app(backend.services))}/v1/inspections/{one}/detections?format={form}"
    with pytest.raises(httpx.RemoteProtocolError):
        httpx.get(url)
    assert httpx.get(url).status_code == 200, "asked again it is whole"


def test_cursors_are_only_those_of_this_table(backend: Backend, client: TestClient) -> None:
    one = f"/v1/inspections/{backend.finished('one', **ROWS)}"
    backend.create("two")
    own = client.get(f"{one}/detections?limit=1").links["next"]["url"].split("cursor=")[1]
    listed = client.get("/v1/inspections?limit=1").links["next"]["url"].split("cursor=")[1]
    wrong = ["x", "AAAA", "W10", listed, own[:-3], "WyJldmVudHMiLDEsMF0", "WyJkZXRlY3Rpb25zIiwxLCJhIl0", "%00"]
    for cursor in wrong:
        answer = client.get(f"{one}/detections?limit=1&cursor={cursor}")
        assert (answer.status_code, answer.json()["code"]) == (400, "bad_cursor"), cursor
    assert client.get(f"/v1/inspections?cursor={own}").status_code == 400
