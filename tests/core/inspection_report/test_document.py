"""What the report says: findings with every part of their place, what was not seen, and what people say."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from core.errors import BadInput
from core.inspection_report.document import Shown, is_day
from core.inspection_report.finding import amount
from core.inspection_report.forms import Form, written
from core.json_files import read_json, write_json
from core.report.limits import limits_document
from core.scene.defect import DefectRecord
from core.settings.limits import parse_limits
from tests.core.inspection_report.making_reports import ROW, changed, document_of, form_of, source_of, text_of
from tests.core.making_results import RESULTS


def finding(document: dict[str, Any], name: str) -> dict[str, Any]:
    found: dict[str, Any] = next(one for one in document["findings"] if one["name"] == name)
    return found


def test_every_finding_of_every_model_is_there_the_largest_first(tmp_path: Path) -> None:
    def sizes(defects: list[dict[str, Any]]) -> None:
        for one, size in zip(defects, (0.2, 0.9, None, 0.5), strict=True):
            one["extent"]["value"] = size

    document = document_of(changed(tmp_path / "result", defects=sizes))
    assert [one["name"] for one in document["findings"]] == ["D1", "D10", "D0", "D2"]
    assert (document["counts"]["findings"], document["counts"]["at_least"]) == (4, 3)
    assert finding(document, "D2")["size"]["text"] == "unknown"


def test_what_is_not_known_of_a_place_is_said(tmp_path: Path) -> None:
    place = finding(document_of(RESULTS / "two_models"), "D0")["place"]
    assert place["text"] == "blade unknown; side unknown; span unknown; chord unknown"
    assert place["blade"] is None
    assert not place["relative"]


def test_a_place_on_the_row_is_told_with_its_spread(tmp_path: Path) -> None:
    folder = changed(tmp_path / "result", defects=lambda defects: defects[0].update(blade="2"))
    write_json(folder / "row.json", ROW)
    document = document_of(folder)
    assert finding(document, "D0")["place"]["text"] == (
        "blade 2 (relative); side: tip; 91 ± 2 % of the span seen, from the root; chord unknown; "
        "7.5 ± 0.25 (unscaled) from the root"
    )
    assert document["counts"]["rows"] == [
        {"blade": "blade 2 (relative)", "by_label": [1, 0], "findings": 1},
        {"blade": "blade unknown", "by_label": [2, 1], "findings": 3},
    ]
    # With a zero blade told, a number is a number.
    write_json(folder / "row.json", {**ROW, "zero_blade": 1})
    assert finding(document_of(folder), "D0")["place"]["text"].startswith("blade 2; ")


def test_columns_of_the_tables_count_before_what_the_row_says(tmp_path: Path) -> None:
    told = {"blade": "2", "side": "concave", "span": 0.25, "span_sigma": 0.01, "chord": 0.5, "chord_sigma": None}
    folder = changed(tmp_path / "result", defects=lambda defects: defects[0].update(told))
    write_json(folder / "row.json", ROW)
    text = finding(document_of(folder), "D0")["place"]["text"]
    assert "side: concave; 25 ± 1 % of the span seen, from the root; 50 % of the chord" in text


def test_what_was_not_seen_of_each_blade_is_said_and_counted(tmp_path: Path) -> None:
    folder = changed(tmp_path / "result", defects=lambda defects: defects[0].update(blade="2"))
    write_json(folder / "row.json", ROW)
    (folder / "models/1/row.json").unlink()
    document = document_of(folder)
    first, second = document["coverage"]
    assert [(one["blade"], one["findings"]) for one in first["blades"]] == [("1", 0), ("2", 1)]
    assert second["status"] == "unknown"
    said = " ".join(document["not_seen"])
    assert "25 % of blade 1 (relative), 60 % of blade 2 (relative)" in said
    assert "2 of 59 to 65 blades of the row appear; the others were not seen" in said
    assert "Model 1: The row of blades is unknown (the row of blades was not looked for)" in said
    assert "4 of 8 frames used have no place in the model" in said
    assert "1 detections have no place: the time of the detection lies outside the video" in said


def test_a_further_model_on_the_same_row_has_the_first_ones_numbers_where_they_are_known(tmp_path: Path) -> None:
    folder = changed(tmp_path / "result")
    write_json(folder / "row.json", {**ROW, "zero_blade": 1})
    write_json(folder / "models/1/row.json", {**ROW, "on_first": {"names": {"2": "7"}}})
    _, second = document_of(folder)["coverage"]
    assert [one["text"] for one in second["blades"]] == ["blade 1-B1 (relative)", "blade 7"]


def test_why_the_row_is_unknown_is_said(tmp_path: Path) -> None:
    folder = changed(tmp_path / "result")
    write_json(folder / "row.json", {"status": "unknown", "reason": "no_repetition", "reason_text": "a hub"})
    assert "The row of blades is unknown (a hub)" in " ".join(document_of(folder)["not_seen"])


@pytest.mark.parametrize(
    ("value", "sigma", "unit", "text"),
    [
        (1.2345, 0.0678, "mm", "1.23 ± 0.068 mm"),
        (1.2345, None, "mm", "1.23 ± unknown mm"),
        (1.2345, 0.0678, "model", "1.23 ± 0.068 (unscaled)"),
        (None, None, "mm", "unknown"),
    ],
)
def test_a_measure_has_its_spread_and_no_unit_that_is_not_known(
    value: float | None, sigma: float | None, unit: str, text: str
) -> None:
    assert amount(value, sigma, unit) == text


def test_a_length_counts_before_the_extent(tmp_path: Path) -> None:
    measured = {"length": 3.5, "length_sigma": 0.2, "length_unit": "mm", "width": 1.25, "width_sigma": 0.1}
    folder = changed(tmp_path / "result", defects=lambda defects: defects[0].update(measured))
    one = finding(document_of(folder), "D0")
    assert (one["size"]["text"], one["size"]["kind"], one["width"]["text"]) == (
        "3.5 ± 0.2 mm",
        "length",
        "1.25 ± 0.1 mm",
    )


def test_what_people_say_stands_beside_what_the_machine_says(tmp_path: Path) -> None:
    folder = changed(tmp_path / "result")
    defects = json.loads((folder / "mapping" / "defects.json").read_text(encoding="utf-8"))

    def record(revision: int, defect: int, action: str, value: object, reason: str = "") -> dict[str, object]:
        one = defects[defect]
        target = {"kind": "defect", "id": one["id"], "label": one["label"], "model": 0, "centroid": one["centroid"]}
        said = {"id": f"r{revision}", "revision": revision, "target": target, "action": action, "value": value}
        return {**said, "reason": reason, "time": f"2026-05-0{revision}T10:00:00Z", "by": "Ada"}

    lost = record(6, 0, "reject", None, "not damage")
    lost["target"] = {"kind": "defect", "id": 99, "label": "crack", "model": 0, "centroid": [50.0, 0.0, 0.0]}
    records = [
        record(1, 0, "relabel", "scratch"),
        record(2, 0, "accept", None),
        record(3, 0, "severity", "monitor"),
        record(4, 0, "note", "seen before"),
        record(5, 1, "reject", None, "duplicate"),
        lost,
    ]
    write_json(folder / "review.json", {"schema_version": 2, "records": records})
    document = document_of(folder)
    human = finding(document, "D0")["human"]
    assert finding(document, "D0")["label"] == "dent"
    assert (human["state"], human["label"], human["disposition"]) == ("accepted", "scratch", "monitor")
    assert human["notes"] == ["seen before (Ada)"]
    assert (finding(document, "D1")["human"]["state"], finding(document, "D1")["human"]["reason"]) == (
        "rejected",
        "duplicate",
    )
    assert finding(document, "D2")["human"]["state"] == "not reviewed"
    review = document["review"]
    assert (review["reviewer"], review["date"], review["decided"]) == ("Ada", "2026-05-05", 2)
    assert review["unattached"] == ["crack: rejected; not damage"]
    assert document_of(folder, reviewer="Bob", day="2026-06-01")["review"]["reviewer"] == "Bob"


@pytest.mark.parametrize("text", ["2026-5-4", "2026-02-30", "today", "20260504", "2026-05-04T10:00:00"])
def test_a_day_is_a_day(text: str) -> None:
    assert is_day("2026-05-04")
    assert not is_day(text)


def test_pictures_are_shown_with_their_boxes_and_a_part_around_them() -> None:
    document = document_of(RESULTS / "two_models")
    for one in document["findings"]:
        frame, close, surface = (one["pictures"][kind] for kind in ("frame", "close_up", "surface"))
        assert surface["file"].endswith(f"viewer/surface/defect_{one['id']:03d}.jpg")
        assert surface["file"].startswith("models/1/") == (one["model"] == 1)
        assert frame["file"] == close["file"]
        assert (RESULTS / "two_models" / frame["file"]).is_file()
        x, y, width, height = close["window"]
        assert 0 <= x <= 1 - width
        assert 0 <= y <= 1 - height
        assert frame["boxes"]
        for x1, y1, x2, y2 in frame["boxes"]:
            assert x <= x1 < x2 <= x + width
            assert y <= y1 < y2 <= y + height


@pytest.mark.parametrize("address", ["../../../../etc/passwd", "../quality.json", "frames/../../summary.json"])
def test_a_document_that_names_other_files_leads_to_none(tmp_path: Path, address: str) -> None:
    def named(page: dict[str, Any]) -> None:
        for one in page["defects"]:
            one["surface_picture"] = address

    folder = changed(tmp_path / "result", viewer=named)
    with pytest.raises(BadInput, match="is no picture of a result's page"):
        source_of(folder).picture(document_of(folder)["findings"][0]["pictures"]["surface"]["file"])


def test_what_is_no_finished_result_is_refused(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=r"no summary.json: is it a finished result"):
        source_of(tmp_path)
    (tmp_path / "summary.json").write_text("[")
    with pytest.raises(BadInput, match=r"summary.json is no JSON"):
        source_of(tmp_path)
    (tmp_path / "summary.json").write_text("[]")
    with pytest.raises(BadInput, match=r"summary.json holds no JSON object"):
        source_of(tmp_path)


MEASURED = {
    "length": 25.4,
    "length_sigma": 2.54,
    "width": 12.7,
    "width_sigma": 1.27,
    "area": 645.16,
    "area_sigma": 64.516,
    "length_unit": "mm",
    "size_from": "box",
    "size_reason": None,
    "size_sigma": {"length": {"outline": 2.54, "pose": 0.0, "surface": 0.0, "scale": 0.0}},
}
SCALE = {"unit": "mm", "value": 2.54, "sigma": 0.0254, "source": "points"}


def test_inches_are_shown_and_numbers_stay_in_millimetres(tmp_path: Path) -> None:
    def told(summary: dict[str, Any]) -> None:
        summary["scale"] = SCALE

    folder = changed(tmp_path / "result", defects=lambda defects: defects[0].update(MEASURED), summary=told)
    document = document_of(folder, shown=Shown(inches=True))
    one = finding(document, "D0")
    texts = [one[name]["text"] for name in ("size", "width", "area")]
    assert texts == ["1 ± 0.1 in", "0.5 ± 0.05 in", "1 ± 0.1 in²"]
    assert (one["size"]["value"], one["size"]["unit"]) == (25.4, "mm")
    assert document["scale"]["text"].startswith("Scale: 0.1 ± 0.001 in in a unit of the model")
    assert finding(document, "D1")["size"]["text"].endswith("(unscaled)"), "what has no scale has no inches"
    for form in (Form.HTML, Form.CSV):
        data = form_of(folder, form, shown=Shown(inches=True)).decode()
        assert ("1 ± 0.1 in" in data) == (form == Form.HTML)
        assert (",25.4,2.54,mm,length," in data) == (form == Form.CSV)


def test_findings_are_compared_with_the_limits_that_are_told(tmp_path: Path) -> None:
    folder = changed(tmp_path / "result", defects=lambda defects: defects[0].update(MEASURED))
    assert finding(document_of(folder), "D0")["limits"] is None
    document = document_of(folder, shown=Shown(limits=parse_limits("length_mm,count\n20,0\n"), inches=True))
    one = finding(document, "D0")["limits"]
    assert one["text"] == "beyond: its length of 1 ± 0.1 in is above the 0.7874 in of line 2"
    assert finding(document, "D1")["limits"]["verdict"] == "cannot_tell"
    assert document["limits"]["rows"] == [
        {"line": 2, "text": "any, anywhere: length at most 0.7874 in, at most 0 on a blade"}
    ]
    source = source_of(folder)
    page = written(Form.HTML, document, source).decode()
    assert "beyond: its length of 1 ± 0.1 in" in page
    assert "Compared at 2 standard deviations" in page
    assert "beyond: its length of 1 ± 0.1 in" in text_of(written(Form.PDF, document, source))
    assert ",beyond,its length of 1 ± 0.1 in is above" in written(Form.CSV, document, source).decode()


def test_the_limits_of_the_result_itself_are_shown(tmp_path: Path) -> None:
    folder = changed(tmp_path / "result", defects=lambda defects: defects[0].update(MEASURED))
    records = [DefectRecord.from_dict(one) for one in read_json(folder / "mapping/defects.json")]
    write_json(folder / "limits.json", limits_document(parse_limits("zone,length_mm\nany,20\n"), records))
    text = finding(document_of(folder), "D0")["limits"]["text"]
    assert text == "beyond: its length of 25.4 ± 2.5 mm is above the 20 mm of line 2"
