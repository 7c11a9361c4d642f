"""Reviews over HTTP: appended under the revision that was seen, folded, and shown beside the machine's tables."""

from __future__ import annotations

import csv
import io
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from core.report.csv_form import unescaped
from core.review.tables import REVIEW_COLUMNS
from store.account_models import Scope
from tests.api.conftest import Backend, client_of
from tests.api.test_results import ROWS

TARGET: dict[str, Any] = {"kind": "defect", "id": 1, "label": "dent", "model": 0, "centroid": [1.0, 2.0, 3.0]}
HOSTILE = '=cmd|" /C calc"!A0 <script>alert(1)</script>'


@pytest.fixture
def path(backend: Backend) -> str:
    return f"/v1/inspections/{backend.finished('one', **ROWS)}"


def say(client: TestClient, path: str, revision: int, action: str = "accept", **more: Any) -> Any:
    body = {"target": TARGET, "action": action, "revision": revision, **more}
    return client.post(f"{path}/reviews", json=body)


def test_records_are_appended_and_read_from_a_revision(client: TestClient, path: str) -> None:
    first = say(client, path, 0)
    assert (first.status_code, first.json()["revision"], first.json()["by"]) == (201, 1, "default")
    assert say(client, path, 1, "note", value=HOSTILE).status_code == 201
    listed = client.get(f"{path}/reviews").json()
    assert [one["action"] for one in listed["records"]] == ["accept", "note"]
    assert listed["severities"] == ["serviceable", "monitor", "reject"]
    assert listed["may_review"] is True
    later = client.get(f"{path}/reviews?since=1").json()
    assert ([one["action"] for one in later["records"]], later["revision"]) == (["note"], 2)
    assert client.get(f"{path}/reviews?since=2").json()["revision"] == 2


def test_a_stale_revision_is_a_conflict_and_nothing_is_lost(client: TestClient, path: str) -> None:
    say(client, path, 0, id="a")
    answer = say(client, path, 0, "reject", reason="duplicate", id="b")
    assert (answer.status_code, answer.json()["code"]) == (409, "stale_revision")
    assert say(client, path, 0, id="a").json()["revision"] == 1, "the same record again is no conflict"
    seen = client.get(f"{path}/reviews").json()["revision"]
    assert say(client, path, seen, "reject", reason="duplicate", id="b").status_code == 201
    folded = client.get(f"{path}/reviewed").json()
    assert folded["findings"][0]["review"]["state"] == "rejected"


def test_undo_is_a_record_too(client: TestClient, path: str) -> None:
    say(client, path, 0, id="a")
    assert say(client, path, 1, "undo", value="a").status_code == 201
    assert client.get(f"{path}/reviewed").json()["findings"][0]["review"]["state"] == "open"
    assert len(client.get(f"{path}/reviews").json()["records"]) == 2
    assert say(client, path, 2, "undo", value="none").status_code == 422


def test_who_is_the_key(backend: Backend, path: str) -> None:
    key, reader = backend.key("default", Scope.READ, Scope.REVIEW), backend.key("default", Scope.READ)
    another = backend.key("another")
    client = client_of(backend)
    answer = client.post(f"{path}/reviews", json={"target": TARGET, "action": "accept", "revision": 0}, headers=key)
    assert answer.json()["by"] == "default's key"
    assert client.get(f"{path}/reviews", headers=reader).json()["may_review"] is False
    refused = client.post(f"{path}/reviews", json={"target": TARGET, "action": "accept", "revision": 1}, headers=reader)
    assert (refused.status_code, refused.json()["code"]) == (403, "missing_scope")
    foreign = client.get(f"{path}/reviews", headers=another)
    assert foreign.status_code == 404


def test_severities_are_a_setting(backend: Backend, path: str) -> None:
    client = client_of(backend.with_settings(severities="fly, blend ,,fly,scrap"))
    assert client.get(f"{path}/reviews").json()["severities"] == ["fly", "blend", "scrap"]
    assert say(client, path, 0, "severity", value="blend").status_code == 201
    refused = say(client, path, 1, "severity", value="monitor")
    assert (refused.status_code, refused.json()["code"]) == (422, "bad_severity")
    other = {**client.get(f"{path}/reviews").json()["records"][0], "id": "x", "value": "monitor"}
    handed = {"schema_version": 2, "records": [other]}
    assert client.post(f"{path}/reviews/import", json=handed).status_code == 422


@pytest.mark.parametrize(
    "change",
    [
        {"action": "explode"},
        {"action": "reject", "reason": "because"},
        {"action": "note", "value": "a\0b"},
        {"action": "note", "value": "x" * 2001},
        {"action": "move", "value": {"point": [1, 2]}},
        {"revision": -1},
        {"revision": 2**31},
        {"id": "a/b"},
        {"target": {"kind": "defect", "id": "x", "label": "dent"}},
        {"target": {"kind": "defect", "id": 2**40, "label": "dent"}},
        {"more": 1},
    ],
)
def test_what_is_no_record_is_refused(client: TestClient, path: str, change: dict[str, Any]) -> None:
    answer = client.post(f"{path}/reviews", json={"target": TARGET, "action": "accept", "revision": 0, **change})
    assert answer.status_code == 422, answer.text
    assert client.get(f"{path}/reviews").json()["records"] == []


def test_a_saved_review_is_handed_over_once(client: TestClient, path: str) -> None:
    say(client, path, 0, id="here")
    old = {"revision": 1, "target": TARGET, "action": "reject", "value": None, "reason": "other", "time": "2026-01-01"}
    undo = {**old, "revision": 2, "action": "undo", "value": 1, "reason": None}
    saved = {"schema_version": 1, "title": "t", "fingerprint": None, "model": 0, "records": [old, undo]}
    answer = client.post(f"{path}/reviews/import", json=saved)
    assert answer.json() == {"added": 2, "known": 0, "revision": 3}
    assert client.post(f"{path}/reviews/import", json=saved).json() == {"added": 0, "known": 2, "revision": 3}
    whole = client.get(f"{path}/reviews").json()
    assert whole["records"][1]["origin"]["time"] == "2026-01-01"
    assert client.post(f"{path}/reviews/import", json=whole).json() == {"added": 0, "known": 3, "revision": 3}
    assert client.get(f"{path}/reviewed").json()["findings"][0]["review"]["state"] == "accepted"


def rows_of(client: TestClient, address: str) -> list[dict[str, str]]:
    answer = client.get(address)
    assert answer.status_code == 200, answer.text
    return list(csv.DictReader(io.StringIO(answer.text)))


def test_tables_show_both_side_by_side(client: TestClient, path: str) -> None:
    machine = {name: client.get(f"{path}/{name}").json() for name in ("defects", "detections", "timeline")}
    say(client, path, 0, "reject", reason="not damage")
    say(client, path, 1, "relabel", value="scratch")
    say(client, path, 2, "note", value=HOSTILE)
    add = {"label": "crack", "frame": 2, "box": [0.1, 0.1, 0.2, 0.2], "point": [0.0, 0.0, 2.0]}
    added = {"kind": "added", "id": "drawn", "label": "crack"}
    answer = say(client, path, 3, "add", value=add, id="drawn", target=added)
    assert answer.status_code == 201, answer.text
    say(client, path, 4, "severity", value="monitor", target=added)
    assert {name: client.get(f"{path}/{name}").json() for name in machine} == machine, "the machine's tables stay"
    defects = client.get(f"{path}/defects?reviewed=1").json()
    assert [(one["id"], one["finding"], one["label"]) for one in defects] == [(1, "D1", "dent"), (None, "H1", None)]
    assert (defects[0]["review"]["label"], defects[0]["review"]["reason"]) == ("scratch", "not damage")
    assert (defects[1]["review"]["label"], defects[1]["review"]["point"]) == ("crack", [0.0, 0.0, 2.0])
    rows = rows_of(client, f"{path}/defects?reviewed=1&format=csv")
    assert [(one["label"], one["human_label"], one["severity"]) for one in rows] == [
        ("dent", "scratch", ""),
        ("", "crack", "monitor"),
    ]
    assert rows[0]["notes"] == f"'{HOSTILE}"
    assert unescaped(rows[0]["notes"]) == HOSTILE
    on = rows_of(client, f"{path}/detections?reviewed=1&format=csv")
    assert [(one["label"], one["finding"], one["human_label"]) for one in on][2] == ("ünïcode", "D1", "scratch")
    assert [one["review_state"] for one in on] == ["", "", "rejected"]
    events = client.get(f"{path}/timeline?reviewed=1").json()
    assert [one["finding"] for one in events] == ["D1", None]
    assert [one["finding"] for one in client.get(f"{path}/defects?reviewed=1&label=crack").json()] == ["H1"]
    assert client.get(f"{path}/defects?reviewed=1&min_confidence=0.1").json() == []


def test_a_reviewed_table_has_another_tag_after_each_record(client: TestClient, path: str) -> None:
    address = f"{path}/defects?reviewed=1"
    tag = client.get(address).headers["etag"]
    assert client.get(address, headers={"If-None-Match": tag}).status_code == 304
    plain = client.get(f"{path}/defects").headers["etag"]
    say(client, path, 0)
    assert client.get(address, headers={"If-None-Match": tag}).status_code == 200
    assert client.get(f"{path}/defects", headers={"If-None-Match": plain}).status_code == 304


def test_people_s_findings_follow_the_last_page(backend: Backend) -> None:
    records = [
        {"id": number, "label": "dent", "x": 0.0, "y": 0.0, "z": 1.0, "record": {"id": number, "label": "dent"}}
        for number in range(3)
    ]
    path = f"/v1/inspections/{backend.finished('paged', defects=records)}"
    client = client_of(backend)
    add = {"label": "crack", "frame": 2, "box": [0.1, 0.1, 0.2, 0.2]}
    say(client, path, 0, "add", value=add, id="d", target={"kind": "added", "id": "d", "label": "crack"})
    first = client.get(f"{path}/defects?reviewed=1&limit=2")
    assert [one["finding"] for one in first.json()] == ["D0", "D1"]
    second = client.get(first.links["next"]["url"])
    assert [one["finding"] for one in second.json()] == ["D2", "H1"]
    assert "next" not in second.links
    assert second.json()[1]["made"]["value"]["unplaced"] == "not_cast"


def test_a_review_of_another_attempt_is_kept_as_unattached(client: TestClient, path: str) -> None:
    far = {**TARGET, "centroid": [9.0, 9.0, 9.0]}
    say(client, path, 0, "note", value="kept", target=far)
    folded = client.get(f"{path}/reviewed").json()
    assert folded["findings"][0]["review"]["notes"] == []
    assert folded["unattached"][0]["review"]["notes"][0]["text"] == "kept"


def test_the_guide_names_the_columns() -> None:
    text = (Path(__file__).parents[2] / "docs" / "api.md").read_text(encoding="utf-8")
    assert [name for name in REVIEW_COLUMNS if f"`{name}`" not in text] == []


def test_the_resource_leads_to_them(client: TestClient, path: str) -> None:
    links = client.get(path).json()["links"]
    assert (links["reviews"], links["reviewed"]) == (f"{path}/reviews", f"{path}/reviewed")
