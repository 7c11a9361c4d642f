"""What names a result: the settings a stage reads, its inputs and the weights it loads."""

from __future__ import annotations

import pytest

import store.graph
from core.graph import TaskSpec
from core.settings import make_settings
from store.graph import CORE_GRAPH


def name_of(stage: str) -> str:
    """Fingerprint of a chunk of `stage` with nothing before it."""
    task = TaskSpec(f"{stage}/000", (), {"start": 0, "end": 8})
    return CORE_GRAPH.fingerprint(task, make_settings("draft"), {}, "v" * 64, None)


@pytest.mark.parametrize(
    ("stage", "uses"), [("features", True), ("matches", True), ("bridge", True), ("depth", False), ("extend", False)]
)
def test_other_weights_make_another_result(stage: str, uses: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    before = name_of(stage)
    monkeypatch.setattr(store.graph, "weights_digest", lambda name: f"another {name}")
    assert (name_of(stage) != before) is uses
