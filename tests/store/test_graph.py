"""What names a result: the settings a stage reads, its inputs and the weights it loads."""

from __future__ import annotations

from dataclasses import replace

import pytest

import store.graph
from core.errors import BadInput
from core.graph import TaskSpec
from core.settings import make_settings
from store.graph import CORE_GRAPH, load_graph
from store.records import InputFiles


def name_of(stage: str) -> str:
    """Fingerprint of a chunk of `stage` with nothing before it."""
    task = TaskSpec(f"{stage}/000", (), {"start": 0, "end": 8})
    return CORE_GRAPH.fingerprint(task, make_settings("draft"), {}, [InputFiles("v", "v" * 64, None, None)])


@pytest.mark.parametrize(
    ("stage", "uses"), [("features", True), ("matches", True), ("bridge", True), ("depth", False), ("extend", False)]
)
def test_other_weights_make_another_result(stage: str, uses: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    before = name_of(stage)
    monkeypatch.setattr(store.graph, "weights_digest", lambda name: f"another {name}")
    assert (name_of(stage) != before) is uses


def test_every_video_is_in_the_name_of_what_reads_videos_and_one_alone_as_ever() -> None:
    probe, a, b = TaskSpec("probe"), InputFiles("a", "a" * 64, None, None), InputFiles("b", "b" * 64, None, None)

    def name(*files: InputFiles) -> str:
        return CORE_GRAPH.fingerprint(probe, make_settings("draft"), {}, files)

    assert len({name(a), name(b), name(a, b), name(b, a)}) == 4
    assert name(a, b) == name(replace(a, video="elsewhere"), b)


@pytest.mark.parametrize("name", ["store.graph:Graph", "store.graph:nothing", "no.module:graph", ""])
def test_a_wrong_graph_is_named_with_the_setting_that_says_it(name: str) -> None:
    with pytest.raises(BadInput, match="stage graph") as caught:
        load_graph(name)
    assert caught.value.where == "BLADEATLAS_GRAPH"


def test_the_right_graph_is_found() -> None:
    assert load_graph("store.graph:CORE_GRAPH") is CORE_GRAPH
