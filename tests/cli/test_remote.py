"""The commands against a real server, as a user calls them."""

from __future__ import annotations

import hashlib
import json
import os
import re
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, TextIO

import httpx
import pytest
from fastapi import FastAPI

from api.app import create_app
from cli import exits
from cli.client import ArtifactInfo, Client
from cli.client.transfers import Transfers
from cli.main import main
from core.errors import BadInput, NoReconstruction, ResourceError
from store.keys import Keys
from tests.api.conftest import VIDEO, Backend, address, backend, serve, unprobed

__all__ = ["address", "backend", "serve", "unprobed"]


@pytest.fixture
def call(address: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any) -> Callable[..., tuple[int, str]]:
    """Runs a command; returns its exit code and standard output."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setenv("BLADEATLAS_SERVER", address)
    monkeypatch.chdir(tmp_path)

    def run(*words: str) -> tuple[int, str]:
        code = main(words)
        return code, str(capsys.readouterr().out)

    return run


@pytest.fixture
def video(tmp_path: Path) -> Path:
    path = tmp_path / "video.mp4"
    path.write_bytes(os.urandom(3_000_000))
    return path


class _Listening:
    """Standard output that starts something once when it is told that a job is running."""

    def __init__(self, stream: TextIO, start: Callable[[], object]) -> None:
        self._stream, self._start, self._heard = stream, start, False

    def write(self, text: str) -> int:
        if "running" in text and not self._heard:
            self._heard = True
            threading.Thread(target=self._start).start()
        return self._stream.write(text)

    def flush(self) -> None:
        self._stream.flush()


def test_submit_watch_and_download_the_sample(
    backend: Backend, call: Callable[..., tuple[int, str]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    code, out = call("submit", str(VIDEO), "--preset", "draft", "--set", "matching.window=8", "--label", "blade 4")
    assert code == exits.DONE
    one = out.strip()
    row = backend.services.inspections.get(one)
    assert row.files[0].video_sha256 == hashlib.sha256(VIDEO.read_bytes()).hexdigest()
    assert row.settings["matching"]["window"] == 8
    assert "blade 4" in call("status", one)[1]
    backend.work(one)
    # The server may show what it looked up a moment ago.
    deadline = time.monotonic() + 10
    while "running" not in call("status", one)[1]:
        assert time.monotonic() < deadline
        time.sleep(0.05)
    files = {"mapping/t.csv": b"1", "dense/f.ply": b"2" * 100}
    with monkeypatch.context() as patch:
        patch.setattr(sys, "stdout", _Listening(sys.stdout, lambda: backend.publish(one, files)))
        code, out = call("watch", one, "--json")
    states = [json.loads(line)["state"] for line in out.splitlines()]
    assert (code, states[0], states[-1]) == (exits.DONE, "running", "succeeded")
    assert call("download", one, "--out", str(tmp_path / "out"), "--include", "mapping/*")[0] == exits.DONE
    assert (tmp_path / "out/mapping/t.csv").read_bytes() == b"1"
    assert not (tmp_path / "out/dense").exists()
    assert call("download", one)[1] == f"2 files in {one}\n"
    assert call("download", one, "--include", "nothing")[0] == exits.BAD_INPUT


@pytest.mark.usefixtures("unprobed")
def test_submit_tells_the_lens_of_a_calibration(
    backend: Backend, call: Callable[..., tuple[int, str]], video: Path, tmp_path: Path
) -> None:
    lens = tmp_path / "cameras.txt"
    lens.write_text("1 PINHOLE 480 360 260 260 240 180\n")
    code, out = call("submit", str(video), "--calibration", str(lens), "--set", "mapper.refine_lens=true")
    assert code == exits.DONE
    kept = backend.services.inspections.get(out.strip()).settings
    assert (kept["camera"]["model"], kept["camera"]["params"]) == ("PINHOLE", [260, 260, 240, 180])
    assert kept["mapper"]["refine_lens"]
    lens.write_text("1 PINHOLE 480 360 260 260\n")
    assert call("submit", str(video), "--calibration", str(lens)) == (exits.BAD_INPUT, "")
    assert len(call("status")[1].splitlines()) == 1, "nothing was sent"


@pytest.mark.usefixtures("unprobed")
def test_a_label_of_somebody_else_is_one_line_of_a_list(call: Callable[..., tuple[int, str]], video: Path) -> None:
    label = "two\nlines \x1b[2J\u202e"
    one = call("submit", str(video), "--label", label)[1].strip()
    said = call("status")[1]
    assert re.sub(r"\([\d.]+ s to [\d.]+ s left\)", "(LEFT)", said) == (
        f"{one}  queued  0%  split  (LEFT)  two\\nlines \\x1b[2J\\u202e\n"
    )
    assert json.loads(call("status", "--json")[1])["label"] == label


@pytest.mark.usefixtures("unprobed")
def test_cancel_and_the_exit_code_of_what_was_cancelled(
    backend: Backend, call: Callable[..., tuple[int, str]], video: Path
) -> None:
    one = call("submit", str(video), "--json")[1]
    name = json.loads(one)["id"]
    assert call("cancel", name)[0] == exits.DONE
    backend.publish(name)
    assert call("watch", name)[0] == exits.INTERRUPTED
    listed = call("status", "--state", "cancelled", "--json")[1].splitlines()
    assert [json.loads(line)["id"] for line in listed] == [name]


def test_failures_have_the_exit_codes_of_a_run(backend: Backend, call: Callable[..., tuple[int, str]]) -> None:
    one = backend.create("one")
    lease = backend.services.plan.lease("me")
    assert lease is not None
    backend.services.plan.fail(lease, NoReconstruction("nothing moves").to_dict(), retry=False)
    backend.publish(one)
    assert call("watch", one)[0] == exits.NO_RECONSTRUCTION
    assert call("watch", "0" * 32)[0] == exits.BAD_INPUT
    assert call("submit", "missing.mp4")[0] == exits.BAD_INPUT
    assert call("submit", str(VIDEO), "--set", "matching.windw=3")[0] == exits.BAD_INPUT
    assert backend.services.inspections.find()[0].id == one


def test_keys_are_made_listed_and_revoked(
    backend: Backend, call: Callable[..., tuple[int, str]], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("BLADEATLAS_DATA_DIR", str(backend.services.settings.data_dir))
    made = json.loads(call("keys", "create", "inspector", "--json")[1])
    assert made["key"] not in json.dumps([str(vars(view)) for view in Keys(backend.db).all()])
    (tmp_path / "key").write_text(made["key"] + "\n")
    monkeypatch.setenv("OTHER", "ba_no_key")
    backend.services.inspections.find()
    httpx.get(os.environ["BLADEATLAS_SERVER"] + "/healthz")
    assert call("status", "--key-file", str(tmp_path / "key"))[0] == exits.DONE
    assert call("status", "--key-env", "OTHER")[0] == exits.BAD_INPUT
    assert call("status", "--key-env", "ABSENT")[0] == exits.BAD_INPUT
    assert "valid" in call("keys", "list")[1]
    assert call("keys", "revoke", made["id"])[0] == exits.DONE
    assert "revoked" in call("keys", "list")[1]


def test_accounts_are_made_changed_exported_and_deleted(
    backend: Backend, call: Callable[..., tuple[int, str]], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setenv("BLADEATLAS_DATA_DIR", str(backend.services.settings.data_dir))
    monkeypatch.setenv("BLADEATLAS_GRAPH", "tests.store.small_plan:GRAPH")
    made = json.loads(call("accounts", "create", "shop", "--max-active", "3", "--json")[1])
    assert (made["id"], made["max_active"], made["retention_days"]) == ("shop", 3, None)
    call("accounts", "set", "shop", "--max-active", "usual", "--retention-days", "7.5")
    assert "shop  open  retention_days=7.5 max_priority=9  shop" in call("accounts", "list")[1]
    assert call("accounts", "set", "shop", "--max-active", "many")[0] == exits.BAD_INPUT
    assert call("keys", "create", "station")[0] == exits.BAD_INPUT, "of which of two accounts is not said"
    key = json.loads(call("keys", "create", "station", "--account", "shop", "--scopes", "read", "--json")[1])
    assert (key["account_id"], key["scopes"]) == ("shop", ["read"])
    for wrong in (("--scopes", "raed"), ("--days", "-1"), ("--days", "nan")):
        assert call("keys", "create", "x", "--account", "shop", *wrong)[0] == exits.BAD_INPUT
    new = call("keys", "rotate", key["id"], "--keep-hours", "1")[1].strip()
    assert new.startswith("ba_")
    done = backend.finished("done", {"quality.json": b"{}"}, owner="shop")
    video = tmp_path / "v.mp4"
    video.write_bytes(b"video")
    backend.services.artifacts.put(backend.services.inspections.get(done).files[0].video, video)
    assert call("accounts", "export", "shop", "--out", str(tmp_path / "out"))[0] == exits.DONE
    record = json.loads((tmp_path / "out" / "account.json").read_text())
    assert [one["id"] for one in record["inspections"]] == [done]
    assert (tmp_path / "out" / done / "inputs" / "video").read_bytes() == b"video"
    assert (tmp_path / "out" / done / "quality.json").read_bytes() == b"{}"
    assert call("accounts", "export", "shop", "--out", str(tmp_path / "out"))[0] == exits.BAD_INPUT
    assert call("accounts", "delete", "shop")[0] == exits.BAD_INPUT, "nothing says that it is meant"
    assert call("accounts", "delete", "shop", "--yes")[0] == exits.DONE
    assert "shop  closed" in call("accounts", "list")[1]
    assert "valid" not in call("keys", "list", "--account", "shop")[1]
    log = call("accounts", "audit", "--limit", "3")[1].splitlines()
    assert [line.split("  ")[2:] for line in log] == [
        ["bladeatlas accounts delete", "shop", "200"],
        ["bladeatlas accounts delete", "shop", "422 bad_input"],
        ["bladeatlas accounts export", "shop", "422 bad_input"],
    ]
    assert new not in call("accounts", "audit", "--json")[1]


class Cut(Exception):
    """The network fails."""


def test_an_upload_that_was_cut_off_goes_on(backend: Backend, address: str, video: Path, tmp_path: Path) -> None:
    transfers = Transfers(tmp_path / "state")
    seen: list[int] = []

    def cut(_name: str, done: int, _total: int) -> None:
        if done >= 2_000_000:
            raise Cut

    with Client(address, transfers=transfers) as client, pytest.raises(Cut):
        client.upload(video, cut)
    uploads, deadline = backend.services.uploads.folder, time.monotonic() + 10.0
    # What was sent lies in the server's buffers for a moment.
    while not any(path.stat().st_size for path in uploads.iterdir()) and time.monotonic() < deadline:
        time.sleep(0.01)
    with Client(address, transfers=transfers) as client:
        upload = client.upload(video, lambda _name, done, _total: seen.append(done))
    assert seen[0] > 0, "it did not begin anew"
    assert backend.services.uploads.path(upload).read_bytes() == video.read_bytes()
    backend.services.uploads.remove(upload)
    with Client(address, transfers=transfers) as client:
        assert client.upload(video) != upload, "an upload that is gone is begun anew"


def test_a_download_goes_on_and_is_checked(backend: Backend, address: str, tmp_path: Path) -> None:
    data = os.urandom(2_500_000)
    one = backend.finished("one", {"dense/fused.ply": data, "empty": b""})
    with Client(address) as client:
        empty, (fused, out) = client.artifacts(one)[1], (client.artifacts(one)[0], tmp_path / "out")
        part = out / "dense" / f".fused.ply.{fused.sha256[:16]}.part"
        part.parent.mkdir(parents=True)
        part.write_bytes(data[:1_000_000])
        seen: list[int] = []
        path = client.download(one, fused, out, lambda _name, done, _total: seen.append(done))
        assert path.read_bytes() == data
        assert min(seen) > 1_000_000
        assert client.download(one, empty, out).read_bytes() == b""
        part.write_bytes(b"x" * len(data))
        path.unlink()
        with pytest.raises(ResourceError, match="damaged"):
            client.download(one, fused, out)
        assert client.download(one, fused, out).read_bytes() == data
        with pytest.raises(BadInput, match="outside"):
            client.download(one, ArtifactInfo("../../x", 1, "0" * 64), out)


@pytest.mark.usefixtures("unprobed")
def test_the_typed_client_covers_the_life_of_an_inspection(backend: Backend, address: str, video: Path) -> None:
    with Client(address, transfers=Transfers(video.parent / "state")) as client:
        one = client.submit(video, parameters={"external_id": "WO-1"}, idempotency_key="order")
        assert client.submit(video, parameters={"external_id": "WO-1"}, idempotency_key="order").id == one.id
        assert [found.id for found in client.list(external_id="WO-1")] == [one.id]
        backend.work(one.id)
        backend.publish(one.id)
        assert client.wait(one.id).state == "succeeded"
        assert client.table(one.id, "detections") == []
        assert client.retry(one.id, "last").raw["attempt"] == 2
        client.delete(one.id)
        client.delete(one.id)
        with pytest.raises(BadInput) as caught:
            client.get(one.id)
        assert caught.value.code == "gone"


def test_a_server_that_stays_away_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cli.client.retry._PAUSE_S", 0.001)
    with Client("http://127.0.0.1:1") as client, pytest.raises(ResourceError) as caught:
        client.get("x")
    assert caught.value.code == "unreachable"


def test_a_server_that_restarts_is_waited_for(
    backend: Backend, serve: Callable[[FastAPI], str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("cli.client.retry._PAUSE_S", 0.001)
    one, answers = backend.create("one"), iter([503, 503])
    app = create_app(backend.services)

    @app.middleware("http")
    async def restarting(request: Any, go_on: Any) -> Any:
        from starlette.responses import Response

        status = next(answers, None)
        return Response(status_code=status) if status else await go_on(request)

    with Client(serve(app)) as client:
        assert client.get(one).state == "queued"
    assert next(answers, None) is None
