"""Processes that lease from one plan at the same time never get the same attempt."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from sqlalchemy import func, select

from core.settings import make_settings
from store.db import Database
from store.inspections import Inspections
from store.models import Attempt
from tests.store.small_plan import FILES, GRAPH

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[2]


def test_two_processes_share_a_plan_without_running_anything_twice(db: Database, tmp_path: Path) -> None:
    Inspections(db, GRAPH).create("one", FILES, make_settings(), "/out")
    url = db.engine.url.render_as_string(hide_password=False)
    command = [sys.executable, "-m", "tests.store.leasing_process", url]
    journals = [tmp_path / f"journal-{i}" for i in range(2)]
    processes = [subprocess.Popen([*command, str(journal)], cwd=ROOT) for journal in journals]
    assert [process.wait(120) for process in processes] == [0, 0]
    lines = [line.split() for journal in journals for line in journal.read_text().splitlines()]
    keys = [key for _, _, key, _ in lines]
    assert sorted(keys) == sorted(["split", *(f"part/{i}" for i in range(25)), "join", "last"])
    assert {accepted for *_, accepted in lines} == {"True"}
    with db.read() as session:
        outcomes = session.execute(select(Attempt.outcome, func.count()).group_by(Attempt.outcome)).all()
    assert [tuple(row) for row in outcomes] == [("succeeded", 28)]
