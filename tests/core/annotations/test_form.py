"""The published JSON Schema and the reader agree; an outline that cannot be meant is left out with a word."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import jsonschema
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core.annotations.form import json_schema
from core.annotations.load import load_annotations
from core.annotations.parse import has_area, parse_annotations
from core.annotations.read import parse_json, read_bytes
from core.errors import BadInput
from tests.core.annotations.test_parse import DETECTIONS, ENTRIES, JSON_VALUES, TIMES
from tests.inputs import INPUTS

ROOT = Path(__file__).parents[3]
VALIDATOR = jsonschema.Draft202012Validator(json_schema())
BEYOND_A_SCHEMA = {"box_inverted", "duplicate_key"}
SHARES = st.sampled_from([0, 0.1, 0.25, 0.5, 1, 1.0])
POLYGONS = st.lists(st.lists(SHARES, min_size=2, max_size=2), max_size=4)
LABELS = st.sampled_from(["dent", " a ", "\u00a0x", "a\n"]) | st.text(max_size=3)
GOOD = st.fixed_dictionaries(
    {"label": LABELS, "bbox": st.lists(SHARES, min_size=4, max_size=4)},
    optional={
        "score": SHARES | st.none(),
        "polygon": POLYGONS | st.none(),
        "track_id": LABELS | st.integers() | st.none(),
        "other": JSON_VALUES,
    },
)
GOOD_ENTRIES = st.fixed_dictionaries(
    {},
    optional={
        "detections": st.lists(GOOD | DETECTIONS, max_size=3) | st.none(),
        "masks": st.lists(st.fixed_dictionaries({"label": LABELS, "polygon": POLYGONS}), max_size=2) | st.none(),
    },
)


def whole_tracks(value: Any) -> bool:
    """Whether no track is a number with a decimal point, which JSON Schema calls an integer."""
    entries = value.values() if isinstance(value, dict) else []
    lists = [entry.get("detections") for entry in entries if isinstance(entry, dict)]
    found = [one for detections in lists if isinstance(detections, list) for one in detections]
    return not any(isinstance(one, dict) and isinstance(one.get("track_id"), float) for one in found)


@settings(max_examples=400, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.dictionaries(TIMES, GOOD_ENTRIES | ENTRIES, max_size=2) | JSON_VALUES)
def test_what_the_schema_accepts_the_reader_accepts(value: Any) -> None:
    valid = VALIDATOR.is_valid(value) and whole_tracks(value)
    code = ""
    try:
        parse_annotations(value)
    except BadInput as error:
        code = error.code
    assert not valid or code in {"", *BEYOND_A_SCHEMA}


@pytest.mark.parametrize(
    "change",
    [
        {"label": ""},
        {"label": "\0"},
        {"label": None},
        {"bbox": [0, 0, 1]},
        {"bbox": [0, 0, 1, 2]},
        {"bbox": [0, 0, 1, True]},
        {"score": "1"},
        {"score": 2},
        {"polygon": [[0, 0, 0]]},
        {"polygon": [0, 0]},
        {"track_id": 1.5},
        {"track_id": ""},
    ],
)
def test_what_the_reader_refuses_the_schema_refuses(change: dict[str, Any]) -> None:
    good = {"label": "dent", "bbox": [0, 0, 1, 1]}
    assert VALIDATOR.is_valid({"1.0": {"detections": [good], "masks": None}})
    wrong = {"1.0": {"detections": [{**good, **change}]}}
    assert not VALIDATOR.is_valid(wrong)
    with pytest.raises(BadInput, match=r'"1\.0"\.detections\[0\]'):
        parse_annotations(wrong)


@pytest.mark.parametrize(
    "value", [[], {"x": {}}, {"-1": {}}, {"1": []}, {"1": {"detections": {}}}, {"1": {"masks": 0}}]
)
def test_other_structures_are_refused_by_both(value: Any) -> None:
    assert not VALIDATOR.is_valid(value)
    with pytest.raises(BadInput):
        parse_annotations(value)


def test_the_sample_is_of_the_form() -> None:
    jsonschema.Draft202012Validator.check_schema(json_schema())
    for path in (ROOT / "samples" / "turbine.json", INPUTS / "nulldet.json"):
        VALIDATOR.validate(parse_json(read_bytes(path)))


@pytest.mark.parametrize(
    ("name", "what"),
    [("poly_off.json", "lies outside of its own box"), ("poly_line.json", "encloses no area")],
)
def test_an_outline_that_cannot_be_meant_is_left_out_with_a_word(name: str, what: str) -> None:
    annotations = load_annotations(INPUTS / name)
    assert annotations.warnings == (f'"0.0000".detections[0].polygon {what} and was left out',)
    first = annotations.detections[0]
    assert (first.polygon, first.box) == (None, (0.45677, 0.46786, 0.49885, 0.52337))


def test_an_outline_that_touches_its_box_is_kept() -> None:
    box = {"label": "dent", "bbox": [0.2, 0.2, 0.4, 0.4]}
    inside = [[0.39, 0.39], [0.6, 0.39], [0.6, 0.6]]
    outside = [[0.4, 0.4], [0.6, 0.4], [0.6, 0.6]]
    kept, left = parse_annotations({"1": {"detections": [{**box, "polygon": p} for p in (inside, outside)]}}).detections
    assert kept.polygon is not None
    assert left.polygon is None


def test_a_mask_along_a_line_is_left_out() -> None:
    line = [[0.1, 0.1], [0.2, 0.2], [0.4, 0.4]]
    annotations = parse_annotations({"1": {"masks": [{"label": "blade", "polygon": line}]}})
    assert (annotations.entries[0].masks, len(annotations.warnings)) == ((), 1)
    assert has_area(((0, 0), (1e-5, 0), (0, 1e-5)))
    assert not has_area(((0.1, 0.1), (0.3, 0.3), (0.7, 0.7)))
