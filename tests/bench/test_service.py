"""The measurements of the service, on files small enough for a test."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from bench.service import interrupted, transfers
from bench.service.overhead import covered
from bench.speed.timing import Table

pytestmark = pytest.mark.slow


def at(second: float) -> datetime:
    return datetime(2026, 1, 1, tzinfo=UTC) + timedelta(seconds=second)


@pytest.mark.parametrize(
    ("intervals", "seconds"),
    [
        ([], 0.0),
        ([(0, 2), (5, 6)], 3.0),
        ([(0, 4), (1, 2), (3, 6)], 6.0),
        ([(3, 6), (0, 4)], 6.0),
    ],
)
def test_seconds_in_which_something_runs(intervals: list[tuple[float, float]], seconds: float) -> None:
    assert covered([(at(begin), at(end)) for begin, end in intervals]) == seconds


def values(table: Table) -> dict[str, object]:
    return {row.name: row.value for row in table.rows}


def test_uploads_reach_the_service_and_the_sink(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(transfers, "UPLOAD_BYTES", 8 << 20)
    found = values(transfers.uploads(tmp_path, 1))
    assert float(str(found["share of the sink"])) > 0


def test_a_download_in_ranges_is_the_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(transfers, "DOWNLOAD_BYTES", 16 << 20)
    assert values(transfers.downloads(tmp_path, 1))["bytes are the same"] == "true"


@pytest.mark.deployment
def test_an_upload_goes_on_after_its_client_or_server_was_killed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(interrupted, "KILLS", 2)
    found = values(interrupted.interrupted(tmp_path))
    killed = [int(str(found[f"{who} killed in the middle of a PATCH"])) for who in ("client", "server")]
    assert sum(killed) == 2
    assert found["files whose SHA-256 is wrong after going on"] == 0
