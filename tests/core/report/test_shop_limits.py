"""Findings against the limits of the shop: with their uncertainty, and never more than is known."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from core.report.build import build_report, write_tables
from core.report.limits import LimitVerdict, limit_text, limits_document
from core.scene.defect import DefectRecord
from core.scene.on_row import RowColumns, Side
from core.scene.size import LengthUnit, Measure, Size
from core.settings import make_settings
from core.settings.limits import parse_limits
from tests.core.making_record import full_record
from tests.core.making_rows import defect


def found(
    length: float | None = 3.4,
    sigma: float = 0.3,
    side: Side | None = Side.CONCAVE,
    span: float | None = 0.5,
    blade: str | None = "4",
    unit: LengthUnit = LengthUnit.MM,
    label: str = "dent",
    number: int = 0,
) -> DefectRecord:
    size = Size(length=None if length is None else Measure(length, sigma, 0.0, 0.0), unit=unit)
    place = RowColumns(side=side, span=span, span_sigma=None if span is None else 0.02)
    return replace(defect(number, label), size=size, on_row=place, blade=blade)


def verdict(table: str, record: DefectRecord) -> tuple[str, str]:
    (one,) = limits_document(parse_limits(table), [record])["findings"]
    return one["verdict"], one["reason"]


@pytest.mark.parametrize(
    ("limit", "expected"),
    [
        (4.1, LimitVerdict.WITHIN),
        (3.9, LimitVerdict.CANNOT_TELL),
        (2.9, LimitVerdict.CANNOT_TELL),
        (2.7, LimitVerdict.BEYOND),
    ],
)
def test_a_length_is_compared_with_two_standard_deviations(limit: float, expected: LimitVerdict) -> None:
    told, reason = verdict(f"length_mm\n{limit}\n", found())
    assert told == expected
    assert "3.4 ± 0.3 mm" in reason
    assert f"{limit} mm of line 2" in reason


def test_without_a_scale_nothing_can_be_told_and_no_number_is() -> None:
    record = found(unit=LengthUnit.MODEL)
    told, reason = verdict("length_mm\n100\n", record)
    assert (told, "no scale is known" in reason) == (LimitVerdict.CANNOT_TELL, True)
    (check,) = limits_document(parse_limits("length_mm\n100\n"), [record])["findings"][0]["checks"]
    assert (check["value"], check["sigma"]) == (None, None)
    assert verdict("length_mm\n100\n", defect(0))[0] == LimitVerdict.CANNOT_TELL
    assert verdict("depth_mm\n100\n", found())[1] == "its depth is not known"


@pytest.mark.parametrize(
    ("row", "record", "expected"),
    [
        ("concave,1,,", found(), LimitVerdict.BEYOND),
        ("convex,1,,", found(), LimitVerdict.NO_LIMIT),
        ("leading_edge,1,,", found(side=Side.EDGE), LimitVerdict.CANNOT_TELL),
        ("leading_edge,9,,", found(side=Side.EDGE), LimitVerdict.WITHIN),
        ("edge,1,,", found(side=Side.TRAILING_EDGE), LimitVerdict.BEYOND),
        ("tip,1,,", found(side=Side.UNKNOWN), LimitVerdict.CANNOT_TELL),
        ("tip,1,,", found(side=None), LimitVerdict.CANNOT_TELL),
        ("any,1,0,0.3", found(), LimitVerdict.NO_LIMIT),
        ("any,1,0,0.5", found(), LimitVerdict.CANNOT_TELL),
        ("any,1,0.4,1", found(), LimitVerdict.BEYOND),
        ("any,1,0,0.3", found(span=None), LimitVerdict.CANNOT_TELL),
    ],
)
def test_a_zone_is_for_a_finding_only_where_that_is_known(row: str, record: DefectRecord, expected: str) -> None:
    assert verdict(f"zone,length_mm,span_from,span_to\n{row}\n", record)[0] == expected


def test_damage_is_a_label_and_the_strictest_row_decides() -> None:
    table = "damage,length_mm\nDENT,5\nany,2\nnick,0.1\n"
    assert verdict(table, found())[0] == LimitVerdict.BEYOND
    assert verdict("damage,length_mm\nnick,0.1\n", found())[0] == LimitVerdict.NO_LIMIT


def test_findings_are_counted_by_blade_and_what_is_not_known_is_not_told() -> None:
    records = [found(number=k, blade="4") for k in range(2)] + [found(number=2, blade="5")]
    table = parse_limits("damage,count\ndent,1\n")
    assert [(one["blade"], one["verdict"]) for one in limits_document(table, records)["counts"]] == [
        ("4", "beyond"),
        ("5", "within"),
    ]
    lost = [*records, found(number=3, blade=None)]
    told = {one["blade"]: one for one in limits_document(table, lost)["counts"]}
    assert (told["4"]["verdict"], told["5"]["verdict"]) == ("beyond", "cannot_tell")
    assert "1 and 1 more that may be of them on blade 5 were found, 1 are allowed by line 2" in told["5"]["reason"]


def test_a_run_with_limits_publishes_the_comparison_and_one_without_does_not(tmp_path: Path) -> None:
    record = full_record()
    assert "limits.json" not in write_tables(build_report(record), tmp_path)
    told = replace(record, settings=make_settings(options={"limits.table": "length_mm,count\n1,0\n"}))
    report = build_report(told)
    assert report.limits is not None
    assert len(report.limits["findings"]) == len(report.defects) > 0
    assert "limits.json" in write_tables(report, tmp_path)


def test_a_limit_in_words() -> None:
    (limit,) = limits_document(parse_limits("zone,damage,length_in,count,span_to\ntip,nick,0.1,2,0.5\n"), [])["limits"]
    assert limit_text(limit) == "nick, tip, span 0% to 50%: length at most 2.54 mm, at most 2 on a blade"
    assert "0.1 in" in limit_text(limit, inches=True)
