"""The resource through its life: seen, listed, waited for, cancelled, tried again, deleted."""

from __future__ import annotations

import threading
import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import httpx
import pytest
from fastapi.testclient import TestClient
from sqlalchemy import update

from core.errors import NoReconstruction, ResourceError
from store.files import ArtifactStore
from store.models import Inspection, Task
from store.status import Statuses
from tests.api.conftest import Backend, client_of
from tests.store.small_plan import result_for


def show(client: TestClient, inspection_id: str) -> dict[str, Any]:
    answer = client.get(f"/v1/inspections/{inspection_id}")
    assert answer.status_code == 200, answer.text
    found: dict[str, Any] = answer.json()
    return found


def fresh(backend: Backend, inspection_id: str) -> dict[str, Any]:
    """Seen by a server that remembers nothing."""
    return show(client_of(backend), inspection_id)


def test_the_resource_follows_the_plan_and_its_progress_never_falls(backend: Backend) -> None:
    one = backend.create("one")
    seen = [fresh(backend, one)]
    for _ in range(6):
        backend.work(one, 1)
        seen.append(fresh(backend, one))
    progress = [body["progress"] for body in seen]
    assert progress == sorted(progress)
    assert (progress[0], seen[0]["stage"], seen[0]["state"]) == (0.0, "split", "queued")
    assert [body["stage"] for body in seen] == ["split", "part", "part", "part", "join", "last", "publish"]
    part = next(stage for stage in seen[2]["stages"] if stage["name"] == "part")
    assert (part["state"], part["done"], part["total"]) == ("running", 1, 3)
    assert (seen[-1]["state"], seen[-1]["cancellable"]) == ("running", False), "over, but not published"
    backend.publish(one)
    done = fresh(backend, one)
    assert (done["state"], done["stage"], done["progress"], done["cancellable"]) == ("succeeded", None, 1.0, False)
    assert done["ended_at"]


def test_times_left_are_intervals_learnt_from_former_inspections(backend: Backend) -> None:
    guessed = fresh(backend, backend.create("first"))["eta_s"]
    assert 0 < guessed[0] < guessed[1], "from what the stages weigh"
    for name in ("a", "b", "c"):
        backend.finished(name)
    with backend.db.write() as session:  # as if they had taken no longer than their stages
        session.execute(update(Task).values(started_at=Task.ended_at))
    later = backend.create("later")
    body = fresh(backend, later)
    assert body["eta_s"] is not None
    low, high = body["eta_s"]
    assert 0 < low <= high
    assert body["queue"]["position"] == 2
    stages = {stage["name"]: stage["eta_s"] for stage in body["stages"]}
    assert stages["join"] == [1.5, 1.5]


def test_a_tag_tells_what_changed(backend: Backend, client: TestClient) -> None:
    one = backend.create("one")
    first = client.get(f"/v1/inspections/{one}")
    tag = {"If-None-Match": first.headers["ETag"]}
    same = client.get(f"/v1/inspections/{one}", headers=tag)
    assert (same.status_code, same.content, same.headers["ETag"]) == (304, b"", first.headers["ETag"])
    assert first.headers["Retry-After"]
    backend.work(one, 1)
    time.sleep(0.25)
    assert client.get(f"/v1/inspections/{one}", headers=tag).status_code == 200
    done = client.get(f"/v1/inspections/{backend.finished('two')}")
    assert "Retry-After" not in done.headers


def test_a_long_poll_ends_with_the_change_it_waits_for(backend: Backend, address: str) -> None:
    one = backend.create("one")
    url = f"{address}/v1/inspections/{one}"
    tag = httpx.get(url).headers["ETag"]
    threading.Timer(0.5, backend.work, (one, 1)).start()
    started = time.monotonic()
    changed = httpx.get(url, params={"wait": 20}, headers={"If-None-Match": tag}, timeout=30)
    assert changed.status_code == 200
    assert 0.3 < time.monotonic() - started < 10
    started = time.monotonic()
    same = httpx.get(url, params={"wait": 0.3}, headers={"If-None-Match": changed.headers["ETag"]})
    assert same.status_code == 304
    assert time.monotonic() - started >= 0.3


def test_many_waiting_clients_share_one_look(backend: Backend, address: str, monkeypatch: pytest.MonkeyPatch) -> None:
    looks: list[str] = []
    read = Statuses.read

    def counted(self: Any, inspection_id: str) -> Any:
        looks.append(inspection_id)
        return read(self, inspection_id)

    monkeypatch.setattr("store.status.Statuses.read", counted)
    one = backend.create("one")

    def wait(_: int) -> int:
        return httpx.get(f"{address}/v1/inspections/{one}?wait=3", timeout=30).status_code

    with ThreadPoolExecutor(30) as pool:
        assert set(pool.map(wait, range(30))) == {200}
    assert len(looks) < 30


def test_lists_are_pages_newest_first(backend: Backend, client: TestClient) -> None:
    made = [backend.create(str(number), label="even" if number % 2 == 0 else "odd") for number in range(5)]
    seen, url = [], "/v1/inspections?limit=2"
    while url:
        answer = client.get(url)
        seen += [body["id"] for body in answer.json()["inspections"]]
        backend.create(f"while reading {len(seen)}")
        link = answer.links.get("next", {}).get("url", "")
        assert bool(link) == bool(answer.json()["next_cursor"])
        url = link
    assert seen == made[::-1]


def test_lists_are_filtered(backend: Backend, client: TestClient) -> None:
    queued = backend.create("queued", label="a", external_id="WO-1")
    over = backend.create("unpublished", label="a")
    backend.work(over)
    done = backend.finished("done")

    def ids(query: str) -> list[str]:
        return [body["id"] for body in client.get(f"/v1/inspections?{query}").json()["inspections"]]

    assert ids("state=queued") == [queued]
    assert ids("state=running") == [over]
    assert ids("state=succeeded&state=queued") == [done, queued]
    assert ids("label=a") == [over, queued]
    assert ids("external_id=WO-1") == [queued]
    assert ids("created_after=2200-01-01T00:00:00Z") == []
    assert ids("created_before=2200-01-01T00:00:00") == [done, over, queued]


@pytest.mark.parametrize(
    ("query", "status"),
    [
        ("cursor=x", 400),
        ("cursor=bnVsbA", 400),
        ("limit=0", 422),
        ("limit=99999999999999999999", 422),
        ("state=idle", 422),
        ("label=%00", 422),
        ("created_after=never", 422),
        ("created_after=0001-01-01T00:00:00%2B14:00", 422),
    ],
)
def test_wrong_queries_are_named(client: TestClient, query: str, status: int) -> None:
    answer = client.get(f"/v1/inspections?{query}")
    assert (answer.status_code, answer.headers["content-type"]) == (status, "application/problem+json")


def test_cancel_stops_and_says_so(backend: Backend, client: TestClient) -> None:
    one = backend.create("one")
    answer = client.post(f"/v1/inspections/{one}/cancel")
    assert answer.status_code == 202
    assert answer.json()["state"] in ("cancelling", "cancelled")
    assert backend.services.inspections.get(one).state == "cancelled"
    assert client.post(f"/v1/inspections/{one}/cancel").status_code == 202
    assert backend.woken[0] == one
    done = backend.finished("done")
    refused = client.post(f"/v1/inspections/{done}/cancel")
    assert (refused.status_code, refused.json()["code"]) == (409, "not_cancellable")


def test_retry_computes_only_what_changed(backend: Backend, client: TestClient) -> None:
    one = backend.finished("one")
    url = f"/v1/inspections/{one}/retry"
    answer = client.post(url, json={"parameters": {"options": {"timeline.radius_fraction": 0.05}, "label": "again"}})
    assert answer.status_code == 202, answer.text
    body = answer.json()
    assert (body["state"], body["attempt"], body["label"]) == ("queued", 2, "again")
    assert body["parameters"]["options"] == {"timeline.radius_fraction": 0.05}
    assert body["progress"] < 1
    states = {task.key: task.state for task in backend.services.inspections.tasks(one)}
    assert (states["join"], states["last"]) == ("succeeded", "runnable")
    assert client.post(url).status_code == 409
    backend.work(one)
    assert client.post(url).status_code == 409, "over, but not published"


def test_retry_from_a_stage_makes_its_results_anew(backend: Backend, client: TestClient) -> None:
    one = backend.finished("one")
    results: ArtifactStore = backend.services.results
    folder = backend.services.settings.folder("artifacts") / "results"
    for task in backend.services.inspections.tasks(one):
        assert task.path is not None
        (folder / task.path).mkdir(parents=True)
        (folder / task.path / "result.json").write_text("{}")
    url = f"/v1/inspections/{one}/retry"
    wrong = client.post(url, json={"from_stage": "meshing"})
    assert (wrong.status_code, wrong.json()["errors"][0]["pointer"]) == (422, "/from_stage")
    assert client.post(url, json={"from_stage": "join"}).status_code == 202
    states = {task.key: task.state for task in backend.services.inspections.tasks(one)}
    assert (states["part/0"], states["join"], states["last"]) == ("succeeded", "runnable", "waiting")
    assert {path.split("/")[0] for path in results.list()} == {"split", "part"}


def test_results_that_another_inspection_builds_on_stay(backend: Backend, client: TestClient) -> None:
    one = backend.finished("one")
    backend.create("two", video="one", options={"timeline.radius_fraction": 0.05})
    answer = client.post(f"/v1/inspections/{one}/retry", json={"from_stage": "join"})
    assert (answer.status_code, answer.json()["code"]) == (409, "conflict")
    assert all(task.path for task in backend.services.inspections.tasks(one))


def test_deleted_is_gone(backend: Backend, client: TestClient) -> None:
    one = backend.create("one")
    url = f"/v1/inspections/{one}"
    assert client.delete(url).status_code == 204
    assert backend.services.inspections.get(one).state == "cancelled"
    for method, path in (("GET", ""), ("GET", "/stages"), ("POST", "/retry"), ("DELETE", ""), ("GET", "/artifacts/x")):
        assert client.request(method, url + path).status_code == 410, path
    assert client.get("/v1/inspections").json()["inspections"] == []


@pytest.mark.parametrize("name", ["x", "0" * 32, "..", "%00", "local", "0" * 31 + "%C3%A9"])
def test_an_id_that_names_nothing_is_not_found(client: TestClient, name: str) -> None:
    for path in ("", "/stages", "/cases", "/frames/0.jpg", "/logs", "/archive.zip", "/quality"):
        answer = client.get(f"/v1/inspections/{name}{path}")
        assert (answer.status_code, answer.headers["content-type"]) == (404, "application/problem+json")
    assert client.post(f"/v1/inspections/{name}/cancel").status_code == 404


@pytest.mark.parametrize(
    ("body", "pointer"),
    [
        ({"parameters": {"label": "\0"}}, "/parameters/label"),
        ({"parameters": {"preset": "fast"}}, "/parameters/preset"),
        ({"parameters": {"options": {"matching.windw": 1}}}, "/parameters/options/matching.windw"),
        ({"from": "mesh"}, "/from"),
    ],
)
def test_a_wrong_retry_is_named_and_changes_nothing(
    backend: Backend, client: TestClient, body: dict[str, Any], pointer: str
) -> None:
    one = backend.finished("one")
    answer = client.post(f"/v1/inspections/{one}/retry", json=body)
    assert answer.status_code == 422
    assert [error["pointer"] for error in answer.json()["errors"]] == [pointer]
    assert client.get(f"/v1/inspections/{one}").json()["attempt"] == 1


@pytest.mark.parametrize(
    ("error", "code", "reason", "retryable"),
    [
        (NoReconstruction("nothing moves", code="no_parallax"), "no_reconstruction", "no_parallax", False),
        (ResourceError("too large", code="oom"), "oom", "oom", True),
    ],
)
def test_a_failed_inspection_carries_its_problem(
    backend: Backend, error: Any, code: str, reason: str, retryable: bool
) -> None:
    one = backend.create("one")
    lease = backend.services.plan.lease("me")
    assert lease is not None
    backend.services.plan.fail(lease, error.to_dict(), retry=False)
    backend.publish(one)
    body = fresh(backend, one)
    assert body["state"] == "failed"
    problem = body["error"]
    assert (problem["code"], problem["reason"], problem["stage"]) == (code, reason, "split")
    assert problem["retryable"] is retryable


def test_flags_of_the_report_are_warnings_of_the_resource(backend: Backend) -> None:
    quality = b'{"flags": [{"code": "few_points", "severity": "warning"}, {"code": "x", "severity": "info"}]}'
    summary = b'{"versions": {"bladeatlas": "9.9"}}'
    one = backend.finished("one", {"quality.json": quality, "summary.json": summary})
    body = fresh(backend, one)
    assert [warned["code"] for warned in body["warnings"]] == ["few_points"]
    assert body["versions"] == {"bladeatlas": "9.9"}


def test_another_account_finds_nothing(backend: Backend) -> None:
    mine, other = backend.key("mine"), backend.key("other")
    one = backend.finished("one", {"summary.json": b"{}"}, owner="mine")
    client = client_of(backend)
    for headers, status in ((mine, 200), (other, 404)):
        for path in ("", "/stages", "/artifacts/summary.json", "/logs"):
            assert client.get(f"/v1/inspections/{one}{path}", headers=headers).status_code == status
        listed = client.get("/v1/inspections", headers=headers).json()["inspections"]
        assert len(listed) == (status == 200)


def test_the_highest_progress_is_remembered(backend: Backend) -> None:
    one = backend.create("one")
    with backend.db.write() as session:
        session.execute(update(Inspection).where(Inspection.id == one).values(progress=0.4))
    lease = backend.services.plan.lease("me")
    assert lease is not None
    assert backend.services.plan.complete(lease, result_for(lease))
    assert fresh(backend, one)["progress"] == 0.4
