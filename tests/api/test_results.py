"""Tables, files, frames and logs of an inspection."""

from __future__ import annotations

import csv
import io
import json
import os
import subprocess
import zipfile
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi.testclient import TestClient
from PIL import Image

from api.routes.frames import draw
from core.report.csv_form import unescaped
from core.scene.case import CASE_COLUMNS
from store.tables import DETECTIONS, TIMELINE
from tests.api.conftest import Backend
from tests.labels import LABELS


def detection(number: int, **more: Any) -> dict[str, Any]:
    row: dict[str, Any] = dict.fromkeys(DETECTIONS.columns)
    row |= {
        "id": number,
        "key": f"{number}.5",
        "time_s": number + 0.5,
        "label": "dent",
        "outcome": "mapped",
        "video": 0,
    }
    return row | {"box_x1": 0.25, "box_y1": 0.25, "box_x2": 0.5, "box_y2": 0.75, "support_points": 3} | more


def case(name: str, **more: Any) -> dict[str, Any]:
    row: dict[str, Any] = dict.fromkeys(CASE_COLUMNS, 0)
    row |= {"mean_reprojection_error_px": 0.5, "median_reprojection_error_px": 0.25, "seconds": 2.5}
    return row | {"name": name, "kind": "coarse", "status": "succeeded", "reason": None, "start_mode": None} | more


ROWS: dict[str, Any] = {
    "cases": [case("seg_000_0000_0090", selected=1, seconds=1.25), case("seg_001_0045_0135", status="no_model")],
    "detections": [
        detection(0, score=0.9, confidence=0.8),
        detection(1, label='nick, "deep"\nedge', outcome="unplaced", reason="no_support", confidence=0.2),
        detection(2, label="ünïcode", frame_index=2, defect_id=1),
    ],
    "events": [
        {
            "event_id": 0,
            "defect_id": 1,
            "label": "dent",
            "start_s": 1.0,
            "end_s": 2.0,
            "n_detections": 2,
            "n_frames": 2,
        },
        {
            "event_id": 1,
            "defect_id": 2,
            "label": "nick",
            "start_s": 5.0,
            "end_s": 6.0,
            "n_detections": 1,
            "n_frames": 1,
        },
    ],
    "defects": [
        {
            **{"id": 1, "label": "dent", "x": 1.0, "y": 2.0, "z": 3.0},
            "record": {
                **{"id": 1, "label": "dent", "centroid": [1.0, 2.0, 3.0], "confidence": None, "blade": None},
                "extent": {"value": 0.5, "unit": "model", "sigma": None},
                "persistence": {"k": 2, "n": 4, "share": 0.5},
                **{"events": [0], "detections": [0, 2], "frames": []},
            },
        }
    ],
}
for _event in ROWS["events"]:
    _event.update({"n_detections": 2, "n_frames": 2, "video": 0, "blade": None})
    _event.update(dict.fromkeys(("x", "y", "z", "radius", "confidence")))


def ids(answer: httpx.Response) -> list[int]:
    assert answer.status_code == 200, answer.text
    return [row["id"] for row in answer.json()]


def test_tables_as_json_are_the_rows(backend: Backend, client: TestClient) -> None:
    one = backend.finished("one", **ROWS)
    url = f"/v1/inspections/{one}"
    assert client.get(f"{url}/detections").json() == ROWS["detections"]
    assert client.get(f"{url}/timeline").json() == ROWS["events"]
    assert client.get(f"{url}/defects").json() == [ROWS["defects"][0]["record"]]
    assert client.get(f"{url}/cases").json() == ROWS["cases"]
    assert client.get(f"{url}/cases/seg_000_0000_0090").json() == ROWS["cases"][0]
    assert client.get(f"{url}/cases/seg_9").status_code == 404
    assert client.get(url).json()["selected_case"] == "seg_000_0000_0090"
    metrics = {row["name"]: row["value"] for row in client.get(f"{url}/metrics").json()}
    assert metrics == {}


def test_tables_as_csv_hold_the_same(backend: Backend, client: TestClient) -> None:
    one = backend.finished("one", **ROWS)
    for name, columns in (("detections", DETECTIONS.columns), ("timeline", TIMELINE.columns), ("cases", CASE_COLUMNS)):
        answer = client.get(f"/v1/inspections/{one}/{name}", headers={"Accept": "text/csv"})
        assert answer.headers["content-type"] == "text/csv; charset=utf-8"
        assert answer.headers["Vary"] == "Accept"
        read = list(csv.DictReader(io.StringIO(answer.text, newline="")))
        expected = ROWS["events" if name == "timeline" else name]
        assert read == [
            {column: "" if row[column] is None else str(row[column]) for column in columns} for row in expected
        ]
        assert answer.text.endswith("\r\n")
    defects = client.get(f"/v1/inspections/{one}/defects?format=csv").text.splitlines()
    assert defects[0].startswith("id,label,model,x,y,z,extent")
    known = "1,dent,,1.0,2.0,3.0,0.5,model,,,0.5,2,4,1,2"
    unmeasured = len(defects[0].split(",")) - len(known.split(","))
    assert defects[1] == known + "," * unmeasured


def test_csv_runs_nothing_in_a_spreadsheet_and_json_holds_the_exact_text(backend: Backend, client: TestClient) -> None:
    keys = json.loads(LABELS.read_bytes()).values()
    labels = sorted({entry["label"] for key in keys for entry in key.get("detections", [])})
    event, defect = ROWS["events"][0], ROWS["defects"][0]
    rows: dict[str, Any] = {
        "detections": [detection(k, label=label, key="+0.5", x=-3.5) for k, label in enumerate(labels)],
        "events": [{**event, "event_id": k, "label": label} for k, label in enumerate(labels)],
        "defects": [
            {**defect, "id": k, "label": label, "record": {**defect["record"], "id": k, "label": label}}
            for k, label in enumerate(labels)
        ],
    }
    one = backend.finished("one", **rows)
    for name in ("detections", "timeline", "defects"):
        url = f"/v1/inspections/{one}/{name}"
        assert [row["label"] for row in client.get(url).json()] == labels
        text = client.get(f"{url}?format=csv").text
        read = list(csv.DictReader(io.StringIO(text, newline=""), strict=True))
        assert [row["label"][:1] for row in read if row["label"].startswith(tuple("=+-@"))] == []
        assert [unescaped(row["label"]) for row in read] == labels
    read = list(
        csv.DictReader(io.StringIO(client.get(f"/v1/inspections/{one}/detections?format=csv").text, newline=""))
    )
    assert {(row["key"], row["x"]) for row in read} == {("'+0.5", "-3.5")}


@pytest.mark.parametrize(
    ("accept", "asked", "kind"),
    [
        ("text/csv", "", "text/csv"),
        ("text/csv", "?format=json", "application/json"),
        ("application/json", "?format=csv", "text/csv"),
        ("text/csv;q=0.5, application/json", "", "application/json"),
        ("text/csv, application/json;q=0.9", "", "text/csv"),
        ("text/*, application/json;q=0.1", "", "text/csv"),
        ("*/*", "", "application/json"),
        ("text/csv;q=x", "", "application/json"),
    ],
)
def test_the_better_of_two_forms_is_sent(
    backend: Backend, client: TestClient, accept: str, asked: str, kind: str
) -> None:
    one = backend.create("one")
    answer = client.get(f"/v1/inspections/{one}/detections{asked}", headers={"Accept": accept})
    assert answer.headers["content-type"].split(";")[0] == kind


def test_tables_are_filtered(backend: Backend, client: TestClient) -> None:
    url = f"/v1/inspections/{backend.finished('one', **ROWS)}"
    assert ids(client.get(f"{url}/detections?outcome=unplaced")) == [1]
    assert ids(client.get(f"{url}/detections", params={"label": "ünïcode"})) == [2]
    assert ids(client.get(f"{url}/detections?min_confidence=0.5")) == [0]
    assert ids(client.get(f"{url}/detections?from_s=1&to_s=1.5")) == [1]
    assert ids(client.get(f"{url}/detections?defect_id=1")) == [2]
    assert ids(client.get(f"{url}/defects?min_confidence=0.1")) == []
    assert [row["event_id"] for row in client.get(f"{url}/timeline?from_s=1.5&to_s=5.5").json()] == [0, 1]
    assert [row["event_id"] for row in client.get(f"{url}/timeline?from_s=2.5").json()] == [1]
    for wrong in ("outcome=lost", "min_confidence=2", "from_s=nan", "defect_id=99999999999", "label=%00", "format=xml"):
        assert client.get(f"{url}/detections?{wrong}").status_code == 422


def test_stages_tell_what_they_took(backend: Backend, client: TestClient) -> None:
    one = backend.finished("one")
    rows = {row["name"]: row for row in client.get(f"/v1/inspections/{one}/stages").json()}
    part = rows["part"]
    assert (part["state"], part["done"], part["total"], part["attempts"]) == ("succeeded", 3, 3, 3)
    assert (part["seconds"], part["peak_rss_bytes"], part["workers"]) == (4.5, 1000, ["worker:1/0"])
    assert part["ended_at"] >= part["started_at"]
    lines = client.get(f"/v1/inspections/{one}/stages?format=csv").text.splitlines()
    assert lines[1].startswith("split,succeeded,1,1,1.0,")


def test_quality_is_the_published_report(backend: Backend, client: TestClient) -> None:
    one = backend.create("one")
    url = f"/v1/inspections/{one}/quality"
    early = client.get(url)
    assert (early.status_code, early.json()["code"], early.json()["retryable"]) == (409, "not_ready", True)
    backend.work(one)
    backend.publish(one, {"quality.json": b'{"verdict": "ok", "funnel": {"detections": 3}, "flags": [{"code": "x"}]}'})
    assert client.get(url).json()["funnel"]["detections"] == 3
    assert client.get(f"{url}?format=csv").text.splitlines()[1:] == [
        "verdict,ok",
        "funnel.detections,3",
        "flags.0.code,x",
    ]
    assert client.get(f"/v1/inspections/{backend.finished('bare')}/quality").status_code == 404


DATA = os.urandom(2_500_000)


@pytest.fixture
def file_url(backend: Backend) -> str:
    one = backend.finished("one", {"dense/fused.ply": DATA, "a b/ü.txt": b"x", "mapping/t.csv": b"1,2\r\n"})
    return f"/v1/inspections/{one}/artifacts/dense/fused.ply"


def test_files_are_listed_with_size_and_hash(client: TestClient, file_url: str) -> None:
    listed = client.get(file_url.removesuffix("/dense/fused.ply")).json()["artifacts"]
    assert [item["path"] for item in listed] == ["a b/ü.txt", "dense/fused.ply", "mapping/t.csv"]
    assert listed[1]["size"] == len(DATA)
    assert client.get(listed[0]["link"]).content == b"x"
    assert (
        client.get(listed[1]["link"], headers={"Accept-Encoding": "identity"}).headers["ETag"]
        == f'"{listed[1]["sha256"]}"'
    )


@pytest.mark.parametrize(
    ("asked", "start", "stop"),
    [
        ("bytes=0-0", 0, 1),
        ("bytes=1000000-", 1_000_000, len(DATA)),
        ("bytes=10-99999999", 10, len(DATA)),
        ("bytes=-5", len(DATA) - 5, len(DATA)),
        ("bytes=-99999999", 0, len(DATA)),
        ("bytes= 5 - 9 ", 5, 10),
    ],
)
def test_a_part_of_a_file(client: TestClient, file_url: str, asked: str, start: int, stop: int) -> None:
    answer = client.get(file_url, headers={"Range": asked})
    assert answer.status_code == 206
    assert answer.content == DATA[start:stop]
    assert answer.headers["Content-Range"] == f"bytes {start}-{stop - 1}/{len(DATA)}"
    assert answer.headers["Content-Length"] == str(stop - start)


@pytest.mark.parametrize("asked", ["bytes=5-4", "bytes=-", "bytes=0-1,5-9", "lines=0-5", "bytes=a-b", "", "bytes=--1"])
def test_a_range_that_is_none_means_the_whole_file(client: TestClient, file_url: str, asked: str) -> None:
    answer = client.get(file_url, headers={"Range": asked})
    assert (answer.status_code, len(answer.content)) == (200, len(DATA))


@pytest.mark.parametrize("asked", [f"bytes={len(DATA)}-", "bytes=9999999999-", "bytes=-0"])
def test_a_range_behind_the_end(client: TestClient, file_url: str, asked: str) -> None:
    answer = client.get(file_url, headers={"Range": asked})
    assert answer.status_code == 416
    assert answer.headers["Content-Range"] == f"bytes */{len(DATA)}"
    assert answer.headers["content-type"] == "application/problem+json"


def test_a_file_that_is_at_hand_is_not_sent_again(client: TestClient, file_url: str) -> None:
    whole = client.get(file_url, headers={"Accept-Encoding": "identity"})
    etag = whole.headers["ETag"]
    assert whole.headers["Accept-Ranges"] == "bytes"
    assert client.get(file_url, headers={"If-None-Match": f'"x", W/{etag}'}).status_code == 304
    assert client.get(file_url, headers={"Range": "bytes=1-", "If-Range": etag}).status_code == 206
    assert client.get(file_url, headers={"Range": "bytes=1-", "If-Range": '"other"'}).status_code == 200
    head = client.head(file_url)
    assert (head.status_code, head.headers["Content-Length"], head.content) == (200, str(len(DATA)), b"")


@pytest.mark.parametrize("path", ["../../bladeatlas.db", "..%2f..%2fbladeatlas.db", "/etc/passwd", "%00", "dense", "x"])
def test_no_path_leaves_the_table(client: TestClient, file_url: str, path: str) -> None:
    answer = client.get(file_url.removesuffix("dense/fused.ply") + path)
    assert answer.status_code == 404


def test_the_archive_holds_what_was_asked_for(client: TestClient, file_url: str) -> None:
    url = file_url.removesuffix("artifacts/dense/fused.ply") + "archive.zip"
    answer = client.get(url)
    assert int(answer.headers["Content-Length"]) == len(answer.content)
    with zipfile.ZipFile(io.BytesIO(answer.content)) as archive:
        assert archive.testzip() is None
        assert archive.read("dense/fused.ply") == DATA
        assert len(archive.namelist()) == 3
    some = client.get(url, params={"include": ["mapping/*", "*.txt"]})
    with zipfile.ZipFile(io.BytesIO(some.content)) as archive:
        assert sorted(archive.namelist()) == ["a b/ü.txt", "mapping/t.csv"]
    assert client.get(url, params={"include": "nothing/*"}).status_code == 404


def test_curl_goes_on_where_it_was_cut(backend: Backend, address: str, file_url: str, tmp_path: Path) -> None:
    out = tmp_path / "fused.ply"
    out.write_bytes(DATA[:1_234_567])
    done = subprocess.run(["curl", "-sS", "-f", "-C", "-", "-o", str(out), address + file_url], check=False)
    assert done.returncode == 0
    assert out.read_bytes() == DATA


def test_a_frame_with_its_boxes(backend: Backend, client: TestClient) -> None:
    one = backend.finished("one", **ROWS)
    assert client.get(f"/v1/inspections/{one}/frames/2.jpg").status_code == 404
    plain = io.BytesIO()
    Image.new("RGB", (200, 100)).save(plain, "JPEG")
    crop = {"x0": 100, "y0": 50, "x1": 300, "y1": 150, "source_width": 400, "source_height": 200}
    colors = {"dent": (255, 0, 0), "ünïcode": (0, 255, 0)}
    drawn = Image.open(io.BytesIO(draw(plain.getvalue(), crop, [detection(0)], colors)))
    assert drawn.size == (200, 100)
    # The box is 100..200 by 50..150 on the source, so its left and upper edges are those of the crop.
    red = drawn.getpixel((100, 50)), drawn.getpixel((50, 0)), drawn.getpixel((150, 50))
    assert red[0][0] > 150  # type: ignore[index]
    assert red[1][0] > 150  # type: ignore[index]
    assert red[2][0] < 60  # type: ignore[index]


def write_log(backend: Backend, inspection_id: str, task: str, *lines: str) -> None:
    folder = backend.services.settings.folder("artifacts") / "logs" / inspection_id
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / f"{task.replace('/', '__')}.log").open("a", encoding="utf-8") as stream:
        stream.writelines(line + "\n" for line in lines)


def record(time_s: int, event: str) -> str:
    return json.dumps({"time": f"2026-05-04T09:00:{time_s:02d}.000+00:00", "event": event, "attempt": 1})


def test_every_log_line_comes_once(backend: Backend, client: TestClient) -> None:
    one = backend.create("one")
    url = f"/v1/inspections/{one}/logs"
    assert client.get(url).json()["lines"] == []
    write_log(backend, one, "split", record(1, "begin"), "Traceback (most recent call last):", record(5, "end"))
    write_log(backend, one, "part/0", record(3, "begin"))
    page = client.get(url).json()
    assert [(line["task"], line["event"]) for line in page["lines"]] == [
        ("split", "begin"),
        ("split", "Traceback (most recent call last):"),
        ("part/0", "begin"),
        ("split", "end"),
    ]
    assert page["lines"][0]["fields"] == {"attempt": 1}
    # A line that is older than what was read, from a task that wrote late, is not lost.
    write_log(backend, one, "part/0", record(4, "late"))
    later = client.get(url, params={"after": page["next"]}).json()
    assert [line["event"] for line in later["lines"]] == ["late"]
    assert client.get(url, params={"after": later["next"]}).json()["lines"] == []
    assert len(client.get(url, params={"task": "part/0"}).json()["lines"]) == 2


def test_logs_come_in_pages(backend: Backend, client: TestClient) -> None:
    one = backend.create("one")
    for task in ("split", "join"):
        write_log(backend, one, task, *(record(number, f"{task} {number}") for number in range(10)))
    seen: list[str] = []
    after: dict[str, str] = {}
    for _ in range(10):
        page = client.get(f"/v1/inspections/{one}/logs", params={"limit": 3, **after}).json()
        seen += [line["event"] for line in page["lines"]]
        after = {"after": page["next"]}
    assert sorted(seen) == sorted(f"{task} {number}" for task in ("split", "join") for number in range(10))
    for wrong in ("x", "eNoDAAAAAAE", "AAAA"):
        assert client.get(f"/v1/inspections/{one}/logs", params={"after": wrong}).status_code == 400


def test_a_log_that_begins_anew_is_read_from_its_begin(backend: Backend, client: TestClient) -> None:
    one = backend.create("one")
    write_log(backend, one, "split", *(record(number, "first attempt") for number in range(5)))
    page = client.get(f"/v1/inspections/{one}/logs").json()
    (backend.services.settings.folder("artifacts") / "logs" / one / "split.log").write_text(
        record(9, "second") + "\nunfinished"
    )
    later = client.get(f"/v1/inspections/{one}/logs", params={"after": page["next"]}).json()
    assert [line["event"] for line in later["lines"]] == ["second"]
