"""Every type of the scene comes back from its JSON form as it was, and unknown words are refused."""

from __future__ import annotations

import ast
import inspect
import json
import textwrap
from dataclasses import asdict, replace
from typing import Any

import pytest

from core.errors import StageFailed
from core.products.contract import read_product
from core.products.search import CaseProduct
from core.scene.case import CASE_COLUMNS, CaseRow, CaseStatus, StartMode
from core.scene.defect import Confidence, DefectRecord, EventRow, Sighting
from core.scene.detection import Detection, DetectionRow
from core.scene.frame import (
    FRAME_COLUMNS,
    Frame,
    FrameRow,
    Role,
    RunFrames,
    SourceFrame,
    frames_of,
    image_name,
    index_of_image,
)
from core.scene.on_row import ROW_COLUMNS
from tests.core.making_products import facts_of
from tests.core.making_rows import defect, detection, mapped, run_frames, unplaced

FRAME = Frame(3, 30, 3000, 1.5, "ab" * 32, Role.NEIGHBOUR)
EVENT = EventRow(1, 0, "dent", 0.5, 1.25, 2, 2, 0.1, 0.2, 0.3, 0.4, None)
BY_CASTING = defect(
    7,
    confidence=Confidence(0.75, {"exists": 0.9, "observations": 2, "share": None}),
    frames=(Sighting(4, 1.0, (0.25, 0.5), True), Sighting(9, 0.5)),
    centroid_sigma=0.01,
    normal=(0.0, 0.0, -1.0),
    approximate_detections=(),
    evidence="gallery/defect_007.jpg",
)
OUTLINED = replace(detection(4), polygon=((0.1, 0.1), (0.2, 0.1), (0.2, 0.3)), track_id=12)


@pytest.mark.parametrize(
    "made", [detection(), OUTLINED, mapped(0, (1.0, 2.0, 3.0)), unplaced(1), FRAME, EVENT, defect(2), BY_CASTING]
)
def test_what_is_written_comes_back(made: Any) -> None:
    text = json.dumps(made.to_dict())
    again = type(made).from_dict(json.loads(text))
    assert again == made
    assert json.dumps(again.to_dict()) == text


def test_a_record_by_the_thesis_has_no_keys_of_the_other_rules() -> None:
    more = {"centroid_sigma", "normal", "approximate_detections", "evidence"}
    assert set(BY_CASTING.to_dict()) - set(defect(2).to_dict()) == more
    assert defect(2).to_dict()["confidence"] is None
    assert defect(2).to_dict()["blade"] is None
    fields = set(DefectRecord.__dataclass_fields__)
    assert set(BY_CASTING.to_dict()) == fields - {"size", "on_row"} | set(ROW_COLUMNS), "nothing measured it"


@pytest.mark.parametrize(
    ("kind", "row"),
    [
        (DetectionRow, {**mapped(0, (1.0, 2.0, 3.0)).to_dict(), "outcome": "lost"}),
        (DetectionRow, {**unplaced(0).to_dict(), "reason": "bad luck"}),
        (DetectionRow, {**mapped(0, (1.0, 2.0, 3.0)).to_dict(), "rung": "guess"}),
        (Frame, {**FRAME.to_dict(), "role": "extra"}),
        (Detection, {**detection().to_dict(), "box": [0.1, 0.2, 0.3]}),
    ],
)
def test_unknown_words_and_torn_values_are_refused(kind: Any, row: dict[str, Any]) -> None:
    with pytest.raises(ValueError):
        kind.from_dict(row)


def test_a_published_frame_has_the_frame_first() -> None:
    row = FrameRow(**asdict(FRAME), registered=1, model=0)
    assert tuple(row.to_dict()) == FRAME_COLUMNS
    assert FRAME_COLUMNS[:6] == tuple(FRAME.to_dict())[:6]
    assert FRAME_COLUMNS[6:] == ("registered", "model", "video"), "new columns stand behind those that were there"


def test_the_frame_table_is_by_index_and_knows_its_search() -> None:
    rows = [frame.to_dict() for frame in run_frames(4, 0.5, every=10)]
    rows[3]["role"] = "added"
    frames = frames_of(rows[::-1])
    assert [frame.index for frame in frames] == [0, 1, 2, 3]
    assert frames.n_search == 3
    assert frames.index_of_source == {SourceFrame(0, 10 * i): i for i in range(4)}
    assert frames.moment_of_index[2] == frames.moments_s[2] == 1.0
    assert RunFrames(()).n_search == len(RunFrames(())) == 0
    assert index_of_image(image_name(12)) == 12


def test_a_case_out_of_its_facts() -> None:
    facts = facts_of(CaseProduct, name="seg_000_0000_0180", status="succeeded", start_mode="warm", vetoed=1)
    row = read_product(CaseProduct, facts, "coarse/x").row(seconds=2.5, selected=True)
    assert (row.status, row.start_mode, row.reason) == (CaseStatus.SUCCEEDED, StartMode.WARM, None)
    assert (row.succeeded, row.vetoed, row.selected, row.seconds) == (True, 1, 1, 2.5)
    assert tuple(row.to_dict()) == CASE_COLUMNS
    with pytest.raises(StageFailed, match="start_mode"):
        read_product(CaseProduct, {**facts, "start_mode": "lukewarm"}, "coarse/x")


@pytest.mark.parametrize("kind", [Frame, FrameRow, CaseRow, DetectionRow, EventRow])
def test_every_column_says_what_it_holds(kind: type) -> None:
    body = ast.parse(textwrap.dedent(inspect.getsource(kind))).body[0].body  # type: ignore[attr-defined]
    fields = [k for k, node in enumerate(body) if isinstance(node, ast.AnnAssign)]
    silent = [body[k].target.id for k in fields if not _is_docstring(body[k + 1])]
    assert fields
    assert not silent


def _is_docstring(node: ast.AST) -> bool:
    text = node.value.value if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) else None
    return isinstance(text, str) and text.endswith(".")
