"""Annotations: what is understood, what is refused and how the place is named, and that nothing else escapes."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core.annotations.checks import parse_time
from core.annotations.load import load_annotations
from core.annotations.model import Annotations
from core.annotations.parse import matching_mask, parse_annotations
from core.annotations.read import MAX_BYTES, parse_json
from core.annotations.summary import summarise
from core.errors import BadInput
from core.geometry.boxes import box_iou
from core.scene.detection import Mask
from tests.inputs import INPUTS

SAMPLE = Path(__file__).parents[3] / "samples" / "turbine.json"
DENT = {"label": "dent", "score": 0.5, "bbox": [0.2, 0.2, 0.4, 0.4]}
SQUARE = [[0.2, 0.2], [0.4, 0.2], [0.4, 0.4], [0.2, 0.4]]


def test_the_sample_is_understood() -> None:
    summary = summarise(load_annotations(SAMPLE))
    assert summary.n_keys == 96
    assert summary.n_detections == 90
    assert summary.detections_by_label == {"coating_loss": 45, "dent": 45}
    assert set(summary.masks_by_label) == {"blade"}
    assert (summary.first_time_s, summary.last_time_s) == (0.0, 7.9167)
    assert summary.n_keys_outside_video is None
    assert summary.warnings == ()


@pytest.mark.parametrize("value", [{}, {"0.0": {}}, {"0.0": {"detections": [], "masks": []}}])
def test_no_detections_are_valid(value: object) -> None:
    assert parse_annotations(value).detections == ()


def test_no_file_means_no_annotations() -> None:
    assert load_annotations(None).entries == ()


@pytest.mark.parametrize(
    ("key", "seconds"),
    [
        ("12.5", Fraction(25, 2)),
        ("0.0833", Fraction(833, 10_000)),
        ("7", Fraction(7)),
        (" 3.0 ", Fraction(3)),
        ("1e-05", Fraction(1, 100_000)),
        ("-0.0", Fraction(0)),
        ("00:01:02.25", Fraction(249, 4)),
        ("10:00:00", Fraction(36_000)),
    ],
)
def test_time_keys_are_exact(key: str, seconds: Fraction) -> None:
    assert parse_time(key) == seconds


@pytest.mark.parametrize("key", ["", "abc", "1,5", "12:3", "00:61:00", "1e999", "NaN", "inf", "٣", "1_0", "9" * 50])
def test_other_keys_are_no_times(key: str) -> None:
    with pytest.raises(BadInput, match="is not a time"):
        parse_time(key)


def test_ids_follow_the_input_order_and_keys_stay_verbatim() -> None:
    value = {"2.0": {"detections": [DENT, DENT]}, "00:00:01": {"detections": [{**DENT, "track_id": 7}]}}
    detections = parse_annotations(value).detections
    assert [(d.id, d.key, d.time_s, d.track_id) for d in detections] == [
        (0, "2.0", 2, None),
        (1, "2.0", 2, None),
        (2, "00:00:01", 1, 7),
    ]
    assert detections[0].box == (0.2, 0.2, 0.4, 0.4)


def test_a_detection_takes_its_own_polygon_or_the_mask_that_fits() -> None:
    near = [[x + 0.02, y] for x, y in SQUARE]
    masks = [
        {"label": "dent", "polygon": near},
        {"label": "dent", "polygon": SQUARE},
        {"label": "crack", "polygon": SQUARE},
    ]
    own = [[0.1, 0.1], [0.9, 0.1], [0.5, 0.9]]
    value = {"1": {"detections": [DENT, {**DENT, "polygon": own}, {**DENT, "label": "nick"}], "masks": masks}}
    polygons = [d.polygon for d in parse_annotations(value).detections]
    assert polygons == [tuple(map(tuple, SQUARE)), tuple(map(tuple, own)), None]


def test_a_mask_fits_from_an_overlap_of_one_half() -> None:
    def square(right: float) -> Mask:
        return Mask("dent", ((0.0, 0.0), (right, 0.0), (right, 0.5), (0.0, 0.5)))

    box = (0.0, 0.0, 1.0, 0.5)
    assert box_iou(box, (0.0, 0.0, 0.5, 0.5)) == 0.5
    assert matching_mask("dent", box, [square(0.5)]) is not None
    assert matching_mask("dent", box, [square(0.49)]) is None


def test_a_contour_without_area_is_left_out_with_a_warning() -> None:
    annotations = parse_annotations({"1": {"masks": [{"label": "blade", "polygon": [[0, 0], [1, 1]]}]}})
    assert annotations.entries[0].masks == ()
    assert annotations.warnings == ('"1".masks[0].polygon has 2 corners and was left out',)


def test_a_coordinate_rounded_over_the_edge_is_moved_onto_it() -> None:
    value = {"1": {"detections": [{**DENT, "bbox": [-1e-9, 0.0, 1.0000004, 1.0]}]}}
    assert parse_annotations(value).detections[0].box == (0.0, 0.0, 1.0, 1.0)


def test_a_byte_order_mark_is_no_mistake() -> None:
    assert parse_json(b"\xef\xbb\xbf{}") == {}


def test_only_the_size_of_a_huge_file_is_looked_at(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    huge = tmp_path / "huge.json"
    with huge.open("wb") as stream:
        stream.truncate(100 * 1000 * 1000)
    assert huge.stat().st_size > MAX_BYTES
    monkeypatch.setattr(Path, "read_bytes", lambda self: pytest.fail("the file was read"))
    with pytest.raises(BadInput, match=r"'huge\.json' has 100 MB") as caught:
        load_annotations(huge)
    assert caught.value.code == "annotations_too_large"


JSON_VALUES = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(),
    lambda inner: st.lists(inner, max_size=5) | st.dictionaries(st.text(max_size=12), inner, max_size=5),
    max_leaves=20,
)
NUMBERS = st.floats(-0.5, 1.5) | JSON_VALUES
POLYGONS = st.lists(st.lists(NUMBERS, min_size=1, max_size=3), max_size=4) | JSON_VALUES
DETECTIONS = st.fixed_dictionaries(
    {"label": st.sampled_from(["dent", "blade"]) | JSON_VALUES},
    optional={
        "score": NUMBERS,
        "bbox": st.lists(NUMBERS, min_size=3, max_size=5) | JSON_VALUES,
        "polygon": POLYGONS,
        "track_id": JSON_VALUES,
    },
)
TIMES = st.decimals(-1, 100, places=3).map(str) | st.text(max_size=8)
ENTRIES = st.fixed_dictionaries(
    {}, optional={name: st.lists(DETECTIONS, max_size=3) | JSON_VALUES for name in ("detections", "masks")}
)


def parsed(value: object) -> tuple[Annotations | None, BadInput | None]:
    """Either the one or the other; any other exception fails the test."""
    try:
        return parse_annotations(value), None
    except BadInput as error:
        return None, error


def test_null_instead_of_a_list_is_an_empty_list() -> None:
    file = INPUTS / "nulldet.json"
    annotations = load_annotations(file)
    assert (len(annotations.entries), annotations.detections) == (96, ())
    box = {"label": "dent", "bbox": [0.1, 0.1, 0.2, 0.2], "score": 1}
    (entry,) = parse_annotations({"1": {"detections": [box], "masks": None}}).entries
    assert (len(entry.detections), entry.masks) == (1, ())
    others: tuple[object, ...] = (0, "", False, {})
    for wrong in others:
        with pytest.raises(BadInput, match="must be a list"):
            parse_annotations({"1": {"detections": wrong}})


def test_a_text_that_no_database_keeps_is_refused_where_it_stands() -> None:
    box = {"bbox": [0.1, 0.1, 0.2, 0.2]}
    for member in ({"label": "de\0nt"}, {"label": "dent", "track_id": "\0"}):
        with pytest.raises(BadInput, match=r'"1"\.detections\[0\]\.(label|track_id) holds the character NUL'):
            parse_annotations({"1": {"detections": [{**box, **member}]}})


@settings(max_examples=80, deadline=None, suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large])
@given(JSON_VALUES | st.dictionaries(TIMES, ENTRIES | JSON_VALUES, max_size=4))
def test_any_json_value_is_understood_or_refused_with_its_place(value: object) -> None:
    annotations, refusal = parsed(value)
    if annotations is None:
        assert refusal is not None
        assert refusal.where
        assert len(refusal.message) < 400
        return
    assert [d.id for d in annotations.detections] == list(range(len(annotations.detections)))
    for detection in annotations.detections:
        x1, y1, x2, y2 = detection.box
        assert 0 <= x1 < x2 <= 1
        assert 0 <= y1 < y2 <= 1
        assert detection.time_s >= 0
        assert detection.polygon is None or len(detection.polygon) >= 3
    json.dumps(summarise(annotations).to_dict(), allow_nan=False)


@settings(max_examples=200, deadline=None)
@given(st.binary(max_size=60) | st.text('[]{}":,0123456789eE+-.NaInfity \\u', max_size=60).map(str.encode))
def test_any_bytes_are_json_or_refused(data: bytes) -> None:
    codes = set()
    try:
        parse_json(data)
    except BadInput as error:
        codes.add(error.code)
    assert codes <= {"annotations_not_utf8", "annotations_malformed", "duplicate_key"}
