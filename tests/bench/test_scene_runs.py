"""Scores that are kept, and the fit of a confidence on them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from bench.scenes import run
from bench.scenes.fit import Sample, fit, held_out, report
from bench.scenes.pooled import confidence_line, false_boxes_line, hard_half, right_share
from bench.scenes.run import DEFAULT, THESIS, Bench
from bench.scenes.spec import Lens, Scene

TINY = Scene("tiny", 5, Lens(64, 48, 90.0), n_frames=2, turn_deg=2.0, n_defects=1)
NAMES = ("constant", "support", "depth")
TRUE = np.array([-1.0, 2.0, 1.0])


def samples(count: int = 4, rows: int = 800) -> list[Sample]:
    rng = np.random.default_rng(0)
    made = []
    for k in range(count):
        features = np.column_stack([np.ones(rows), rng.normal(size=(rows, 2))])
        right = rng.random(rows) < 1.0 / (1.0 + np.exp(-features @ TRUE))
        made.append(Sample(f"scene-{k}", features, right, NAMES))
    return made


def test_a_fit_finds_the_weights_that_made_the_rows() -> None:
    weights = fit(samples())
    assert [weights[name] for name in NAMES] == pytest.approx(TRUE.tolist(), abs=0.15)


def test_what_speaks_for_a_place_is_never_held_against_it() -> None:
    turned = [Sample(one.scene, one.features * [1.0, 1.0, -1.0], one.right, NAMES) for one in samples()]
    weights = fit(turned)
    assert weights["depth"] == 0.0
    assert weights["support"] > 1.0


def test_a_scene_without_a_right_place_fits_nothing() -> None:
    failed = Sample("failed", samples(1)[0].features, np.zeros(800, bool), NAMES)
    assert fit([*samples(), failed]) == fit(samples())


def test_every_scene_counts_the_same() -> None:
    small, large = samples(1, 60)[0], samples(1, 3000)[0]
    flipped = Sample("flipped", large.features, ~large.right, NAMES)
    balanced = fit([small, flipped])
    assert abs(balanced["support"]) < 0.5 * TRUE[1], "fifty times the rows do not outvote the other scene"


def test_scenes_left_out_are_judged_by_the_others() -> None:
    stated, right = held_out(samples())
    assert len(stated) == len(right) == 3200
    sure = stated > 0.8
    assert right[sure].mean() == pytest.approx(stated[sure].mean(), abs=0.05)
    text = report([*samples(), Sample("empty", np.zeros((0, 3)), np.zeros(0, bool), NAMES)])
    assert "empty: 0 mapped rows" in text
    assert "scenes left out: calibration error 0.0" in text


def test_a_score_is_kept_until_something_it_depends_on_changes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[str] = []

    def once(_self: Bench, scene: Scene, column: Any, _source: Path) -> dict[str, Any]:
        calls.append(f"{column.name}/{scene.seed}")
        return {"seconds": 1.0, "verdict": "ok", "flags": []}

    monkeypatch.setattr(Bench, "_run", once)
    bench = Bench(tmp_path)
    for _ in range(2):
        assert bench.score(TINY, DEFAULT)["verdict"] == "ok"
    assert calls == ["default/5"]
    assert bench.known(TINY, DEFAULT)["verdict"] == "ok"
    assert bench.known(TINY, THESIS) == {}
    bench.score(TINY, THESIS)
    bench.score(replace(TINY, seed=6), DEFAULT)
    assert calls == ["default/5", "thesis/5", "default/6"]
    monkeypatch.setattr(run, "program_digest", lambda: "another program entirely")
    bench.score(replace(TINY, seed=6), DEFAULT)
    assert calls[-1] == "default/6"
    assert len(calls) == 4
    (tmp_path / "results" / "default" / "tiny.json").write_text("cut off")
    bench.score(replace(TINY, seed=6), DEFAULT)
    assert len(calls) == 5


def scored(mapped: int, wrong: int, placeable: int, stated: list[list[float]], false: int = 0) -> dict[str, Any]:
    boxes = {"count": false, "mapped_confident_persistent_share": 0.5 if false else None}
    place = {"mapped_placeable": mapped, "wrong_mapped": wrong, "placeable": placeable, "false_boxes": boxes}
    return {"score": {"placement": place, "confidence": {"stated": stated}}}


def test_the_hard_half_has_the_smallest_shares_of_right_places() -> None:
    scenes = [replace(TINY, name=name) for name in "abcde"] + [replace(TINY, name="f", expect="flagged")]
    thesis = {
        "a": scored(9, 0, 10, []),
        "b": scored(9, 8, 10, []),
        "c": scored(40, 0, 100, []),
        "d": scored(10, 0, 10, []),
        "e": scored(5, 0, 10, []),
    }
    assert hard_half(scenes, thesis) == ["b", "c"]
    assert right_share(scored(0, 0, 0, [])) == 0.0


def test_figures_over_scenes_are_of_all_their_rows() -> None:
    found = [scored(2, 0, 2, [[0.9, 1.0], [0.8, 1.0]], 2), scored(2, 1, 2, [[0.2, 0.0], [0.9, 1.0]])]
    line = confidence_line("confidence", found)
    assert "4 mapped rows of 2 scenes, 75.0 % right" in line
    assert "AUROC 1.000" in line
    assert "calibration error 0.150" in line
    assert false_boxes_line(found) == "false boxes: 2; mapped with confidence and persistence above 0.5: 1"
    assert "no mapped row" in confidence_line("x", [scored(0, 0, 1, [])])
