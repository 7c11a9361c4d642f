"""The report of an inspection as the service makes it."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from core.inspection_report.forms import POLICY
from tests.api.conftest import Backend, client_of
from tests.core.inspection_report.making_reports import text_of
from tests.core.making_results import RESULTS


@pytest.fixture
def one(backend: Backend) -> str:
    """Path of an inspection whose files are those of a committed result."""
    folder = RESULTS / "two_models"
    files = {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}
    records = json.loads(files["mapping/defects.json"])
    names = ("id", "label", "model")
    rows = [{**{name: one[name] for name in names}, **_place(one), "record": one} for one in records]
    return f"/v1/inspections/{backend.finished('one', files, defects=rows)}"


def _place(record: dict[str, Any]) -> dict[str, float]:
    return dict(zip("xyz", record["centroid"], strict=True))


def test_the_resource_leads_to_the_report(client: TestClient, one: str) -> None:
    answer = client.get(client.get(one).json()["links"]["report"])
    assert answer.headers["content-type"] == "application/pdf"
    assert answer.headers["content-disposition"] == 'inline; filename="report.pdf"'
    text = text_of(answer.content)
    assert all(name in text for name in ("D0: dent", "D1: nick", "D2: dent", "D10: dent"))
    assert "No such picture is kept" not in text


def test_every_form_tells_the_same(client: TestClient, one: str) -> None:
    document = client.get(f"{one}/report.json").json()
    assert [finding["name"] for finding in document["findings"]] == ["D0", "D1", "D2", "D10"]
    page = client.get(f"{one}/report.html")
    assert page.headers["content-security-policy"] == POLICY
    assert page.headers["content-type"] == "text/html; charset=utf-8"
    assert all(f"{finding['name']}: {finding['label']}" in page.text for finding in document["findings"])
    rows = csv.DictReader(io.StringIO(client.get(f"{one}/report.csv").text, newline=""))
    assert [row["finding"] for row in rows] == ["D0", "D1", "D2", "D10"]


def test_texts_are_in_inches_where_these_are_asked_for(backend: Backend, client: TestClient) -> None:
    folder = RESULTS / "two_models"
    scale = {"unit": "mm", "value": 2.54, "sigma": 0.254, "source": "points"}
    files = {name: (folder / name).read_bytes() for name in ("summary.json", "quality.json")}
    files["summary.json"] = json.dumps({**json.loads(files["summary.json"]), "scale": scale}).encode()
    report = f"/v1/inspections/{backend.finished('one', files)}/report.json"
    texts = [client.get(report, params=asked).json()["scale"]["text"] for asked in ({}, {"units": "in"})]
    assert [text.split(" in a unit")[0] for text in texts] == ["Scale: 2.54 ± 0.25 mm", "Scale: 0.1 ± 0.01 in"]
    assert client.get(report, params={"units": "cm"}).status_code == 422


def test_the_day_is_that_on_which_it_ended_or_the_one_asked_for(client: TestClient, one: str) -> None:
    ended = client.get(one).json()["ended_at"][:10]
    assert client.get(f"{one}/report.json").json()["review"] == {
        "reviewer": None,
        "date": ended,
        "decided": 0,
        "unattached": [],
    }
    asked = client.get(f"{one}/report.json?date=2026-05-04&reviewer=Ada").json()["review"]
    assert (asked["date"], asked["reviewer"]) == ("2026-05-04", "Ada")
    refused = client.get(f"{one}/report.json?date=2026-02-30")
    assert (refused.status_code, refused.json()["errors"][0]["pointer"]) == (422, "/date")


@pytest.mark.parametrize("form", ["pdf", "json"])
def test_what_is_at_hand_is_not_made_again(client: TestClient, one: str, form: str) -> None:
    first = client.get(f"{one}/report.{form}")
    again = client.get(f"{one}/report.{form}", headers={"If-None-Match": first.headers["etag"]})
    assert (again.status_code, again.content) == (304, b"")
    assert client.get(f"{one}/report.{form}").content == first.content
    other = client.get(f"{one}/report.{form}?reviewer=Ada", headers={"If-None-Match": first.headers["etag"]})
    assert other.status_code == 200


def test_what_people_say_is_in_the_next_report(client: TestClient, one: str) -> None:
    before = client.get(f"{one}/report.json")
    found = next(row for row in client.get(f"{one}/defects").json() if row["id"] == 1)
    target = {"kind": "defect", "id": 1, "label": found["label"], "model": 0, "centroid": found["centroid"]}
    for revision, said in enumerate(({"action": "accept"}, {"action": "severity", "value": "monitor"})):
        answer = client.post(f"{one}/reviews", json={"target": target, "revision": revision, **said})
        assert answer.status_code == 201, answer.text
    after = client.get(f"{one}/report.json", headers={"If-None-Match": before.headers["etag"]})
    human = {row["name"]: row["human"] for row in after.json()["findings"]}
    assert (human["D1"]["state"], human["D1"]["disposition"], human["D1"]["by"]) == ("accepted", "monitor", "default")
    assert human["D0"]["state"] == "not reviewed"
    assert after.json()["review"]["decided"] == 1
    assert "accepted" in text_of(client.get(f"{one}/report.pdf").content)


def test_what_is_no_report_is_refused(client: TestClient, backend: Backend, one: str) -> None:
    assert client.get(f"{one}/report.docx").status_code == 404
    running = backend.create("running")
    answer = client.get(f"/v1/inspections/{running}/report.pdf")
    assert (answer.status_code, answer.json()["code"]) == (409, "not_ready")
    assert client.get(f"/v1/inspections/{'0' * 32}/report.pdf").status_code == 404


def test_the_house_has_its_style(backend: Backend, one: str, tmp_path: Path) -> None:
    style = tmp_path / "style"
    style.mkdir()
    own = Path(__file__).parents[2] / "core/inspection_report/templates/style.typ"
    named = own.read_text(encoding="utf-8").replace("organisation = none", 'organisation = "House of Blades"')
    (style / "style.typ").write_text(named, encoding="utf-8")
    before = client_of(backend).get(f"{one}/report.pdf")
    object.__setattr__(
        backend.services, "settings", backend.services.settings.model_copy(update={"report_style": style})
    )
    after = client_of(backend).get(f"{one}/report.pdf", headers={"If-None-Match": before.headers["etag"]})
    assert after.status_code == 200
    assert "House of Blades" in text_of(after.content)
