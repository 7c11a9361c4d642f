"""What results say of themselves against what was right."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from bench.main import main
from bench.verdicts import Judged, counts, of_bench, of_result
from core.errors import BadInput
from tests.bench.synthetic import BOXES, N_FRAMES, defects, detection, write_result, write_truth


def keep(folder: Path, name: str, found: dict[str, Any]) -> None:
    path = folder / "results" / f"{name}.json"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(found))


def clip(verdict: str, position: list[float] | None, *flags: str) -> dict[str, Any]:
    return {"clip": "x", "verdict": verdict, "flags": flags, "score": {"registered": 9, "position_percent": position}}


def scene(name: str, verdict: str, position_mm: list[float | None]) -> dict[str, Any]:
    place = {"position_median_mm": position_mm[0], "position_p95_mm": position_mm[1]}
    score = {"placement": place, "frames": {"registered": 7}}
    return {"scene": name, "verdict": verdict, "flags": [], "score": score}


def test_right_is_within_the_limits_of_median_and_tail(tmp_path: Path) -> None:
    keep(tmp_path, "product/right", clip("ok", [0.5, 1.6]))
    keep(tmp_path, "product/off", clip("ok", [0.51, 0.6]))
    keep(tmp_path, "product/tail", clip("ok", [0.1, 1.7]))
    keep(tmp_path, "product/none", clip("refused", None))
    # The chord of this scene is 27 mm: 0.81 mm are 3 %.
    keep(tmp_path, "default/easy", scene("easy", "ok", [0.80, 2.69]))
    keep(tmp_path, "default/wide", scene("wide", "ok", [0.82, 1.0]))
    keep(tmp_path, "default/still", scene("still", "refused", [None, None]))
    keep(tmp_path, "colmap/right", {"clip": "x", "score": {"registered": 9, "position_percent": [9, 9]}})
    judged = {one.name: one for one in of_bench(tmp_path)}
    assert {name: one.right for name, one in judged.items()} == {
        "product/right": True,
        "product/off": False,
        "product/tail": False,
        "product/none": None,
        "default/easy": True,
        "default/wide": False,
        "default/still": None,
    }
    assert judged["default/still"].hopeless
    assert not judged["product/none"].hopeless
    assert judged["default/easy"].errors_percent == pytest.approx((100 * 0.80 / 27, 100 * 2.69 / 27))


def test_suspected_right_ones_and_trusted_wrong_ones_are_counted() -> None:
    right, wrong = (0.1, 0.2), (2.0, 9.0)
    judged = [
        Judged("a", "ok", (), 9, right, "path"),
        Judged("b", "suspect", ("few_points",), 9, right, "path"),
        Judged("c", "ok", (), 9, wrong, "path"),
        Judged("d", "suspect", ("bent_model",), 9, wrong, "path"),
        Judged("e", "refused", ("bent_model",), 9, right, "path"),
        Judged("f", "refused", (), 0, None, "chord", hopeless=True),
        Judged("g", "ok", (), 9, None, "path"),
    ]
    assert counts(judged) == [
        "right models: 2; called suspect: 1 (50 %): b",
        "wrong models: 2; called ok: 1: c",
        "refused: 2, of them hopeless 1, with a model that was right 1: e",
    ]
    assert counts([])[0] == "right models: 0; called suspect: 0"


def test_a_result_folder_is_scored_against_its_truth(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    truth, result = tmp_path / "truth", tmp_path / "result"
    truth.mkdir()
    result.mkdir()
    write_truth(truth)
    center = defects()[0]["surface_center"]
    write_result(result, detections=[detection(frame, BOXES[0], center) for frame in range(3)])
    with pytest.raises(BadInput, match=r"no quality\.json"):
        of_result(result, truth)
    flags = [{"code": "few_points", "severity": "warning"}, {"code": "times_repaired", "severity": "info"}]
    (result / "quality.json").write_text(json.dumps({"verdict": "suspect", "flags": flags}))
    one = of_result(result, truth)
    assert one.right
    assert one.errors_percent == pytest.approx((0, 0), abs=1e-6)
    assert main(["verdicts", "--result", str(result), str(truth)]) == 0
    printed = capsys.readouterr().out
    assert f"| `result` | suspect | `few_points` | {N_FRAMES} | 0.00 / 0.00 % of the chord | yes |" in printed
    assert "called suspect: 1 (100 %): result" in printed


def test_what_holds_no_scores_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["verdicts", str(tmp_path)]) == 2
    assert "holds no scores" in capsys.readouterr().err
    assert main(["verdicts"]) == 2
    assert "no result was named" in capsys.readouterr().err
    keep(tmp_path, "default/nobody", scene("nobody", "ok", [1.0, 2.0]))
    assert main(["verdicts", str(tmp_path)]) == 2
    assert "no scene is called nobody" in capsys.readouterr().err
