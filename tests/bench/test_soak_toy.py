"""The quick form of the soak: a whole deployment of its own, every kind of fault once, stages that take a moment."""

from __future__ import annotations

import json
import shutil
from collections import Counter
from pathlib import Path

import pytest

from bench.main import main

ROOT = Path(__file__).resolve().parents[2]
KINDS = {"kill_worker", "kill_all_workers", "kill_api", "empty_redis", "restart_postgres", "freeze_worker"}
TRANSFERS = {"kill_api_during_upload": 2, "kill_api_during_download": 2}


@pytest.mark.deployment
@pytest.mark.long
def test_every_kind_of_fault_costs_nothing(tmp_path: Path) -> None:
    if shutil.which("redis-server") is None or not list(Path("/usr/lib/postgresql").glob("*/bin/initdb")):
        pytest.skip("the soak starts servers of its own, and their programs are not installed")
    samples = ["--video", str(ROOT / "samples/turbine.mp4"), "--annotations", str(ROOT / "samples/turbine.json")]
    code = main(["soak", str(tmp_path), "--toy", "--jobs", "4", "--faults", "10", "--pause-s", "2", *samples])
    report = json.loads((tmp_path / "soak.json").read_text())
    assert report["disturbed"]["wrong"] == report["undisturbed"]["wrong"] == []
    assert code == 0
    assert set(report["disturbed"]["states"].values()) == {"succeeded"}
    faults = Counter(report["disturbed"]["faults"])
    assert {*KINDS, *TRANSFERS} == set(faults)
    assert TRANSFERS.items() <= faults.items()
    assert report["disturbed"]["duplicates"] > 0
    published = list((tmp_path / "disturbed-toy-4/files").glob("*/sparse/points3D.bin"))
    assert len(published) == 4
    assert len({path.read_bytes() for path in published}) == 4, "no two jobs share a result"
