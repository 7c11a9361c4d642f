"""Events over real connections: in order, without a loss when a stream is cut, to who may read them."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient
from sqlalchemy import text

from api.app import create_app
from api.services import make_services
from core.settings import Settings
from store.events import EventType
from store.factory import open_artifacts, open_database
from store.housekeeping import Retention
from store.keys import Keys
from store.settings import DeploymentSettings
from tests.api.conftest import Backend, wait_until
from tests.databases import BOTH, database_url
from tests.store.small_plan import GRAPH

pytestmark = pytest.mark.slow

STREAM = {"Accept": "text/event-stream"}
Event = tuple[int | None, str, dict[str, Any]]
LIFE = [
    *("inspection.queued", "inspection.running", "inspection.stage", "inspection.stage", "inspection.stage"),
    *("inspection.stage", "inspection.succeeded"),
]


@pytest.fixture(params=BOTH)
def place(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Backend]:
    """A service on either database."""
    with database_url(request.param, tmp_path) as url:
        settings = DeploymentSettings(
            data_dir=tmp_path, database_url=url.render_as_string(hide_password=False), reserve_bytes=0
        )
        db = open_database(settings)
        yield Backend(make_services(settings, db, open_artifacts(settings), wake=lambda _: None, graph=GRAPH))
        db.close()


def parse(lines: Iterator[str]) -> Iterator[Event]:
    """Events of a stream; a heartbeat is one without a name."""
    number, name, data = None, "", {}
    for line in lines:
        if line.startswith("id: "):
            number = int(line[4:])
        elif line.startswith("event: "):
            name = line[7:]
        elif line.startswith("data: "):
            data = json.loads(line[6:])
        elif line.startswith(":"):
            yield None, "", {}
        elif not line and name:
            yield number, name, data
            number, name, data = None, "", {}


@contextmanager
def stream(url: str, **headers: str) -> Iterator[Iterator[Event]]:
    with httpx.stream("GET", url, headers={**STREAM, **headers}, timeout=30) as answer:
        assert answer.status_code == 200
        assert answer.headers["content-type"].startswith("text/event-stream")
        yield parse(answer.iter_lines())


def test_the_life_of_an_inspection_is_told_and_ends(place: Backend, serve: Callable[[FastAPI], str]) -> None:
    address = serve(create_app(place.services))
    place.create("another")
    one = place.create("one", label="row 3", metadata={"module": "HPT"})

    def work() -> None:
        place.work(one)
        place.finish(one)

    threading.Timer(0.3, work).start()
    with stream(f"{address}/v1/inspections/{one}/events") as events:
        seen = list(events)
    assert [name for _, name, _ in seen if name] == [*LIFE, "end"]
    told = [data for _, name, data in seen if name.startswith("inspection.")]
    assert [data["inspection"]["stage"] for data in told] == ["split", "split", "part", "join", "last", "publish", None]
    assert {data["inspection"]["id"] for data in told} == {one}
    assert told[0]["inspection"]["metadata"] == {"module": "HPT"}
    numbers = [number for number, name, _ in seen if name.startswith("inspection.")]
    assert numbers == sorted(numbers, key=lambda number: number or 0)
    with stream(f"{address}/v1/inspections/{one}/events", **{"Last-Event-ID": str(numbers[-1])}) as events:
        assert [name for _, name, _ in events] == ["end"], "who comes back after the end is told so at once"


def test_a_stream_that_is_cut_again_and_again_loses_nothing(place: Backend, serve: Callable[[FastAPI], str]) -> None:
    """Several write at once, so that transactions end in another order than they began."""
    app = create_app(place.services)
    app.state.bladeatlas.feed.heartbeat_s = 0.5
    address = serve(app)
    names = [place.create(f"job {number}") for number in range(6)]
    before = httpx.get(f"{address}/v1/events?limit=1000").json()
    assert [one["type"] for one in before["events"]] == ["inspection.queued"] * 6

    def run(name: str) -> None:
        place.work(name)
        place.finish(name)

    working = [threading.Thread(target=run, args=(name,)) for name in names]
    for thread in working:
        thread.start()
    seen: list[Event] = []
    last, until = str(before["last"]), time.monotonic() + 30
    while sum(kind == EventType.SUCCEEDED for _, kind, _ in seen) < len(names):
        with stream(f"{address}/v1/events", **{"Last-Event-ID": last}) as events:
            some = [event for event in islice(events, 3) if event[1]]  # then the client cuts it off
        seen += some
        last = str(some[-1][0]) if some else last
        assert time.monotonic() < until, "the work has stopped"
    for thread in working:
        thread.join()
    assert [number for number, _, _ in seen] == list(range(7, 7 + len(seen))), "every number once, in order"
    kept = httpx.get(f"{address}/v1/events?limit=1000").json()["events"]
    assert kept[6:] == [data for _, _, data in seen], "what was streamed is what there is"
    for name in names:
        told = [kind for _, kind, data in seen if data["inspection"]["id"] == name]
        assert (told[0], told[-1], set(told[1:-1])) == (LIFE[1], LIFE[-1], {"inspection.stage"}), told


def test_a_change_that_is_rolled_back_has_no_event(place: Backend) -> None:
    one = place.create("one")
    client = TestClient(create_app(place.services), "http://127.0.0.1", client=("127.0.0.1", 1))

    def made_and_rolled_back() -> None:
        with place.db.write() as session:
            place.services.inspections.create_in(session, "f" * 32, _files(place, one), _settings(place, one), "")
            raise RuntimeError

    with pytest.raises(RuntimeError):
        made_and_rolled_back()
    other = place.create("other")
    told = client.get("/v1/events").json()["events"]
    assert [(event["number"], event["inspection"]["id"]) for event in told] == [(1, one), (2, other)]


def _files(place: Backend, inspection_id: str) -> Any:
    return place.services.inspections.get(inspection_id).files


def _settings(place: Backend, inspection_id: str) -> Any:
    return Settings.model_validate(place.services.inspections.get(inspection_id).settings)


def test_streams_are_bounded_and_hold_no_connection(backend: Backend, serve: Callable[[FastAPI], str]) -> None:
    app = create_app(backend.with_settings(max_event_streams_per_owner=3, max_event_streams=4).services)
    app.state.bladeatlas.feed.heartbeat_s = 0.2
    address = serve(app)
    one = backend.create("one")
    url = f"{address}/v1/inspections/{one}/events"
    with stream(url) as first, stream(url) as second, stream(f"{address}/v1/events") as third:
        assert next(first)[1] == next(second)[1] == "inspection.queued"
        assert next(third)[1] == "", "a heartbeat"
        refused = httpx.get(url, headers=STREAM)
        assert (refused.status_code, refused.json()["code"]) == (429, "too_many_event_streams_of_owner")
        wait_until(lambda: _checked_out(backend) == 0)
        assert httpx.get(url).json()["last"] == 1, "pages are not streams"
    wait_until(lambda: httpx.get(url, headers={**STREAM, "Last-Event-ID": "x"}).status_code == 400)
    wait_until(lambda: app.state.bladeatlas.feed._open.total() == 0)
    with stream(url) as again:
        assert next(again)[1] == "inspection.queued"


def _checked_out(backend: Backend) -> int:
    pool: Any = backend.db.engine.pool
    return int(pool.checkedout())


def test_a_stream_ends_with_its_key_and_shows_its_account_only(
    backend: Backend, serve: Callable[[FastAPI], str]
) -> None:
    mine, theirs = backend.create("mine", owner="shop"), backend.create("theirs", owner="other")
    key = backend.key("shop")
    app = create_app(backend.services)
    app.state.bladeatlas.feed.heartbeat_s, app.state.bladeatlas.keys.fresh_s = 0.2, 0.0
    address = serve(app)
    assert httpx.get(f"{address}/v1/inspections/{theirs}/events", headers=key).status_code == 404
    with stream(f"{address}/v1/events?after=0", **key) as events:
        number, _, data = next(events)
        assert (number, data["inspection"]["id"]) == (1, mine)
        Keys(backend.db).revoke(key["Authorization"].split("_")[1])
        httpx.get(f"{address}/v1/events", headers=key)  # any request asks the keys anew
        assert {name for _, name, _ in events} <= {""}, "then it is over"


def test_other_changes_are_told_too(backend: Backend, client: TestClient) -> None:
    one, two = backend.finished("one"), backend.create("two")
    client.patch(f"/v1/inspections/{one}", json={"label": "renamed"})
    client.post(f"/v1/inspections/{one}/retry")
    client.delete(f"/v1/inspections/{two}")
    said = client.get("/v1/events?limit=1000").json()["events"]
    kinds = {event["type"] for event in said}
    assert {EventType.RENAMED, EventType.DELETED, EventType.CANCELLING} <= kinds
    assert {event["inspection"]["attempt"] for event in said if event["inspection"]["id"] == one} == {1, 2}
    rest = client.get("/v1/events", params={"after": said[2]["number"], "limit": 2}).json()
    assert [event["number"] for event in rest["events"]] == [said[3]["number"], said[4]["number"]]
    assert rest["last"] == said[4]["number"]
    with backend.db.write() as session:
        session.execute(text("UPDATE inspection_events SET at = '2001-01-01'"))
    Retention(backend.db).tidy()
    assert client.get("/v1/events").json()["events"] == []
