"""All that an account has, over HTTP."""

from __future__ import annotations

import io
import json
import zipfile

from store.account_models import Scope
from store.models import Inspection
from tests.api.conftest import Backend, client_of


def test_an_account_takes_all_that_it_has_and_nothing_of_others(backend: Backend) -> None:
    manager = backend.key("mine", Scope.MANAGE)
    one = backend.finished("one", {"summary.json": b"{}", "mapping/mesh.ply": b"ply" * 1000}, owner="mine")
    gone = backend.finished("gone", {"summary.json": b"{}"}, owner="mine")
    backend.key("others")
    backend.finished("two", {"secret.json": b"{}"}, owner="others")
    with backend.db.read() as session:
        video = session.get_one(Inspection, one).video_path
        source = backend.services.settings.folder("made") / "video"
    source.write_bytes(b"a video")
    backend.services.artifacts.put(video, source)
    backend.services.artifacts.remove(f"published/{gone}/summary.json")  # as retention does at any moment
    backend.services.uploads.create("mine", 5, {"filename": "left.mp4"})

    answer = client_of(backend).get("/v1/accounts/mine/export.zip", headers=manager)
    assert (answer.status_code, answer.headers["content-type"]) == (200, "application/zip")
    with zipfile.ZipFile(io.BytesIO(answer.content)) as archive:
        assert archive.testzip() is None
        names = {"account.json", f"{one}/inputs/video", f"{one}/summary.json", f"{one}/mapping/mesh.ply"}
        assert set(archive.namelist()) == names
        assert archive.read(f"{one}/mapping/mesh.ply") == b"ply" * 1000
        record = json.loads(archive.read("account.json"))
    assert {item["id"] for item in record["inspections"]} == {one, gone}
    assert record["uploads"][0]["upload_metadata"] == {"filename": "left.mp4"}
    assert manager["Authorization"].rsplit("_", 1)[1] not in answer.text


def test_who_may_export(backend: Backend) -> None:
    keys = {
        200: backend.key("mine", Scope.MANAGE),
        403: backend.key("mine", Scope.READ),
        404: backend.key("others", Scope.MANAGE),
    }
    admin = backend.key("others", Scope.ADMIN)
    client = client_of(backend)
    for status, headers in keys.items():
        assert client.get("/v1/accounts/mine/export.zip", headers=headers).status_code == status
    assert client.get("/v1/accounts/mine/export.zip", headers=admin).status_code == 200
    assert client.get("/v1/accounts/none/export.zip", headers=admin).status_code == 404
