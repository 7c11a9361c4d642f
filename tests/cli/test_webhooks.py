"""`bladeatlas webhooks` in the database of a server."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cli.main import main
from store.db import Database, sqlite_url
from store.webhooks import Webhooks
from tests.databases import put_new_tables

URL = "https://192.0.0.9/hook"


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("BLADEATLAS_DATA_DIR", str(tmp_path))
    put_new_tables(tmp_path / "bladeatlas.db")
    return tmp_path


def test_a_webhook_is_made_tested_and_deleted(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["webhooks", "create", URL, "--types", "inspection.failed", "--json"]) == 0
    made = json.loads(capsys.readouterr().out)
    assert made["secret"].startswith("whsec_")
    assert main(["webhooks", "test", made["id"]]) == 0
    capsys.readouterr()
    assert main(["webhooks", "deliveries", made["id"], "--json"]) == 0
    delivery = json.loads(capsys.readouterr().out)
    assert (delivery["type"], delivery["state"]) == ("webhook.test", "pending")
    assert main(["webhooks", "redeliver", made["id"], delivery["id"]]) == 0
    assert main(["webhooks", "rotate", made["id"], "--keep-hours", "1"]) == 0
    assert "whsec_" in capsys.readouterr().out
    assert main(["webhooks", "list"]) == 0
    listed = capsys.readouterr().out
    assert f"{made['id']}  default  good  inspection.failed  {URL}" in listed
    assert "whsec_" not in listed
    assert main(["webhooks", "delete", made["id"]]) == 0
    database = Database(sqlite_url(folder / "bladeatlas.db"))
    assert Webhooks(database).all() == []
    database.close()


@pytest.mark.parametrize(
    "words",
    [
        ("create", "https://127.0.0.1/"),
        ("create", "nothing"),
        ("create", URL, "--types", "inspection.lost"),
        ("delete", "0" * 32),
        ("deliveries", "0" * 32, "--limit", "0"),
    ],
)
def test_what_cannot_be_is_exit_code_2(words: tuple[str, ...]) -> None:
    assert main(["webhooks", *words]) == 2
