"""The checks run for a case: its right model passes, measured rotations that it contradicts reject it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.spatial.transform import Rotation

from core.scene.case import CASE_COLUMNS
from core.settings import make_settings
from core.sparse.case_stage import case_checks, is_rejected
from core.sparse.cases import Case, run_case
from core.stage import StageTask
from core.stages import coarse
from core.viewgraph import read_table, write_table
from tests.core.sparse.scene import make_scene, view_graph, write_graph


def test_a_bent_model_is_rejected_and_a_straight_one_is_not(tmp_path: Path) -> None:
    scene = make_scene(16, 600)
    case = Case(write_graph(tmp_path / "graph", scene, view_graph(scene)), 0, 16, make_settings().mapper, 0)
    result = run_case(case)
    assert not is_rejected(case_checks(result, case))

    # Turning the second half of the model by 7 degrees is the same as turning what was measured across the cut.
    table = read_table(case.graph / "graph.npz")
    across = (table.pairs[:, 0] < 8) & (table.pairs[:, 1] >= 8)
    turned = table.rotation_xyzw.copy()
    seam = Rotation.from_euler("z", 7, degrees=True)
    turned[across] = (Rotation.from_quat(turned[across]) * seam).as_quat()
    write_table(case.graph / "graph.npz", replace(table, rotation_xyzw=turned))
    checks = case_checks(result, case)
    assert is_rejected(checks)
    bent = next(check for check in checks if check.code == "bent_model")
    np.testing.assert_allclose(bent.value or 0.0, 7, atol=1)
    assert bent.where == "between frames 7 and 8"


def test_a_case_says_every_column_that_it_can_know_in_their_order(tmp_path: Path) -> None:
    scene = make_scene(16, 600)
    graph = write_graph(tmp_path / "graph", scene, view_graph(scene))
    args = {"name": "seg_000_0000_0002", "start": 0, "end": 2, "warm_from": ""}
    task = StageTask("coarse/x", args, make_settings(), {"graph": graph}, {}, (), tmp_path)
    product = coarse.run(task)
    facts = product.facts
    known = [name for name in CASE_COLUMNS if name not in ("seconds", "selected", "vetoed")]
    assert list(facts) == [*known, "checks", "vetoed"]
    assert (facts["kind"], facts["status"], facts["reason"]) == ("coarse", "no_model", "too_few_frames")
    row = product.row(seconds=1.0, selected=False)
    assert {name: getattr(row, name) for name in known} == {name: facts[name] for name in known}
    bad = replace(product, reason="").row(seconds=None, selected=False)
    assert bad.reason is None


def test_without_a_model_nothing_is_rejected(tmp_path: Path) -> None:
    scene = make_scene(16, 600)
    case = Case(write_graph(tmp_path / "graph", scene, view_graph(scene)), 0, 2, make_settings().mapper, 0)
    checks = case_checks(run_case(case), case)
    assert (checks, is_rejected(checks)) == ([], False)
