"""What version 0.1.0 wrote is served, asked and continued by today's code; no one has to compute anything again."""

from __future__ import annotations

import csv
import hashlib
import io
import json
import re
import time
import zipfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import httpx
import pytest
from fastapi.testclient import TestClient
from sqlalchemy import delete

from api.app import create_app
from api.services import Services, make_services
from bench.soak.toy import GRAPH
from cli.main import main
from core.errors import BadInput
from core.settings import make_settings
from core.videos import Recording
from store.account_models import ApiKey
from store.db import open_sqlite
from store.factory import open_artifacts, open_database
from store.settings import DeploymentSettings
from tests.old_release import answers, missing, unpack
from tests.worker import fake_stages
from tests.worker.deployment import Deployment
from tests.worker.test_serve import serve
from worker.events import Event
from worker.local_run import run_inspection

OF_THE_SERVER = re.compile(r"\.body\.request_id: |\.versions\.|\.progress: ")
"""Every request has an id of its own, an inspection tells the versions of the program that answers, and how far it has
come follows what stages are known to take."""
TUS = {"Tus-Resumable": "1.0.0", "Content-Type": "application/offset+octet-stream"}


@dataclass(frozen=True)
class OldService:
    """A data folder of that version under today's application, and what that version said about it."""

    services: Services
    said: dict[str, Any]

    def client(self, key: str = "") -> TestClient:
        headers = {"Authorization": f"Bearer {self.said['keys'][key]}"} if key else {}
        application = create_app(self.services)
        return TestClient(application, "http://127.0.0.1", client=("127.0.0.1", 50000), headers=headers)

    def url(self, name: str) -> str:
        return f"/v1/inspections/{self.said['inspections'][name]}"


@pytest.fixture
def old(tmp_path: Path) -> Iterator[OldService]:
    settings = DeploymentSettings(data_dir=unpack("service", tmp_path), reserve_bytes=0)
    database = open_database(settings)
    services = make_services(settings, database, open_artifacts(settings), wake=lambda _: None, graph=GRAPH)
    yield OldService(services, answers("service"))
    database.close()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return unpack("result", tmp_path)


def differences(client: TestClient, said: dict[str, Any]) -> list[str]:
    """What of the old answers is no longer answered."""
    found = []
    for path, before in said.items():
        answer = client.get(path)
        if answer.headers["content-type"].startswith("text/csv"):
            before = {**before, "body": table(before["body"])}
            now = {"status": answer.status_code, "body": table(answer.text)}
            now["body"]["columns"] = now["body"]["columns"][: len(before["body"]["columns"])]
        else:
            now = {"status": answer.status_code, "body": answer.json()}
        found += [one for one in missing(before, now, path) if not OF_THE_SERVER.search(one)]
    return found


def table(text: str) -> dict[str, Any]:
    """A CSV file by columns: later versions may have further ones, behind those that were there."""
    rows = list(csv.DictReader(io.StringIO(text)))
    return {"columns": next(csv.reader(io.StringIO(text))), "rows": rows}


def test_a_key_sees_what_it_saw_and_of_others_nothing(old: OldService) -> None:
    assert differences(old.client("inspector"), old.said["with_key"]) == []
    shown = old.client("inspector").get("/v1/inspections").json()["inspections"]
    assert {f"/v1/inspections/{one['id']}" for one in shown} == {old.url("owned"), old.url("failed")}


def test_a_revoked_key_opens_nothing(old: OldService) -> None:
    assert old.client("revoked").get("/v1/inspections").status_code == 401
    assert old.client().get(old.url("ownerless")).status_code == 401


def test_what_was_made_before_there_were_keys_is_served_without_any(old: OldService) -> None:
    with old.services.db.write() as session:
        session.execute(delete(ApiKey))
    assert differences(old.client(), old.said["without_keys"]) == []
    assert old.client().get(old.url("deleted")).status_code == 410


def test_every_file_comes_down_whole_alone_and_in_the_archive(old: OldService) -> None:
    client = old.client("inspector")
    listed = client.get(f"{old.url('owned')}/artifacts").json()["artifacts"]
    hashes = {item["path"]: item["sha256"] for item in listed}
    assert "sparse/points3D.bin" in hashes
    for item in listed:
        assert hashlib.sha256(client.get(item["link"]).content).hexdigest() == item["sha256"], item["path"]
    with zipfile.ZipFile(io.BytesIO(client.get(f"{old.url('owned')}/archive.zip").content)) as archive:
        packed = {name: hashlib.sha256(archive.read(name)).hexdigest() for name in archive.namelist()}
    assert packed == hashes


def test_an_open_upload_goes_on_and_both_become_an_inspection(old: OldService) -> None:
    client = old.client("inspector")
    video, begun = (f"/v1/uploads/{old.said['uploads'][name]}" for name in ("finished", "open"))
    whole = old.services.uploads.path(video.rsplit("/", 1)[1]).read_bytes()
    offset = int(client.head(begun, headers=TUS).headers["Upload-Offset"])
    assert 0 < offset < len(whole)
    sent = client.patch(begun, content=whole[offset:], headers={**TUS, "Upload-Offset": str(offset)})
    assert (sent.status_code, sent.headers["Upload-Offset"]) == (204, str(len(whole)))
    assert old.services.uploads.path(begun.rsplit("/", 1)[1]).read_bytes() == whole
    for upload in (video, begun):
        made = client.post("/v1/inspections", json={"video_upload": upload.rsplit("/", 1)[1]})
        assert made.status_code == 202, made.text
        assert made.json()["input_sha256"]["video"] == hashlib.sha256(whole).hexdigest()


def test_a_failed_inspection_can_be_tried_again(old: OldService) -> None:
    client = old.client("inspector")
    again = client.post(f"{old.url('failed')}/retry")
    assert (again.status_code, again.json()["attempt"]) == (202, 2)
    assert client.delete(old.url("owned")).status_code == 204
    assert client.get(old.url("owned")).status_code == 410


@pytest.mark.deployment
def test_a_server_works_on_in_the_folder_and_removes_nothing(tmp_path: Path) -> None:
    said, data = answers("service"), unpack("service", tmp_path)
    database = open_sqlite(data / "bladeatlas.db")
    place = Deployment(data, database, {"BLADEATLAS_GRAPH": "bench.soak.toy:GRAPH", "BLADEATLAS_STALE_S": "0"})
    key, failed = {"Authorization": f"Bearer {said['keys']['inspector']}"}, said["inspections"]["failed"]
    try:
        with httpx.Client(base_url=serve(place), headers=key, timeout=30) as http:
            assert http.post(f"/v1/inspections/{failed}/retry").status_code == 202
            place.wait(failed)
            time.sleep(4.0)  # longer than a round of the cleaner
            for path in (path for path in said["with_key"] if path.endswith("/artifacts") and failed not in path):
                listed = http.get(path).json()["artifacts"]
                assert missing(said["with_key"][path]["body"]["artifacts"], listed) == []
                assert all(len(http.get(item["link"]).content) == item["size"] for item in listed)
            begun = http.head(f"/v1/uploads/{said['uploads']['open']}", headers=TUS)
            assert 0 < int(begun.headers["Upload-Offset"]) < int(begun.headers["Upload-Length"])
    finally:
        place.stop()
        database.close()


def test_questions_get_the_answers_they_got(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    asked = answers("result")["questions"]
    assert {words[0] for words, _ in asked} == {"point", "views"}
    for words, before in asked:
        assert main([words[0], str(folder), *words[1:]]) == 0
        assert missing(before, json.loads(capsys.readouterr().out), " ".join(words)) == []


def test_another_input_is_refused_in_an_old_folder(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    before = (folder / "summary.json").read_bytes()
    annotations = folder.parent / "input" / "clip.json"
    fewer = dict(list(json.loads(annotations.read_text(encoding="utf-8")).items())[1:])
    other = tmp_path / "other.json"
    other.write_text(json.dumps(fewer), encoding="utf-8")
    words = ["run", str(annotations.with_suffix(".mp4")), str(other), "--out", str(folder), "--preset", "draft"]
    assert main(words) == 2
    assert "holds the result of another input" in capsys.readouterr().err
    assert (folder / "summary.json").read_bytes() == before


def test_the_same_input_goes_on_in_an_old_folder(folder: Path) -> None:
    video = folder.parent / "input" / "clip.mp4"
    settings = make_settings(options=fake_stages.SMALL)

    def interrupt(event: Event) -> None:
        if event.kind == "opened":
            raise KeyboardInterrupt

    begun = run_inspection(
        [Recording(video, video.with_suffix(".json"))], folder, make_settings("draft"), on_event=interrupt
    )
    assert begun.state == "interrupted"
    assert (folder / "mapping" / "defects.json").is_file(), "nothing is taken away before there is something new"
    ended = run_inspection([Recording(video, video.with_suffix(".json"))], folder, settings, graph=fake_stages.GRAPH)
    assert (ended.state, ended.reused) == ("succeeded", 0)
    with pytest.raises(BadInput, match="another input"):
        run_inspection([Recording(video)], folder, settings, graph=fake_stages.GRAPH)
