"""Files that are not quite of a format are read or refused, and in no long time."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from core.annotations.load import annotations_from
from core.annotations.model import Annotations
from core.errors import BadInput
from tests.core.annotations.foreign.test_readers import CVAT_VIDEO
from tests.core.making_annotations import FRAME, read, zipped
from tests.inputs import INPUTS

ROOT = Path(__file__).parents[4]
FOREIGN = INPUTS / "foreign"


def test_long_texts_take_no_long_time() -> None:
    coco = json.loads((FOREIGN / "coco.json").read_text())
    coco["images"][0]["file_name"] = ".jpg" * 200_000 + "x"
    with pytest.raises(BadInput, match="has no frame number in its name"):
        read(coco)
    labelled = {"data": {"image": ".jpg?" * 200_000 + "\n"}, "annotations": [{"result": []}]}
    assert read([labelled], FRAME).entries == ()
    with pytest.raises(BadInput, match="text of another kind"):
        read("1" * 1_000_000 + "x 1 1 1 1")
    files = {"frame_1.txt": "0 " + "1" * 500_000 + "x", "data.yaml": "names: &a [b]\nx: [*a, *a]"}
    with pytest.raises(BadInput, match="holds no annotations"):
        read(zipped(files))


EXAMPLES = [json.loads(path.read_text()) for path in sorted(FOREIGN.glob("*.json"))]
EXAMPLES += [json.loads(path.read_text()) for path in sorted((FOREIGN / "tools").glob("*.json"))]
VALUES: st.SearchStrategy[Any] = st.sampled_from(
    [None, True, -1, 0, 1.5, 1e300, float("nan"), "", "x", "9" * 30, [], {}, [[]], [None], {"a": 1}, 10**12]
)


def places(value: Any, path: tuple[Any, ...] = ()) -> list[tuple[Any, ...]]:
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    return [path] + [place for key, one in inner for place in places(one, (*path, key))]


def changed(value: Any, path: tuple[Any, ...], new: Any) -> Any:
    if not path:
        return new
    copy = value.copy()
    copy[path[0]] = changed(value[path[0]], path[1:], new)
    return copy


@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(st.data())
def test_any_change_of_an_example_is_read_or_refused(data: st.DataObject) -> None:
    value = data.draw(st.sampled_from(EXAMPLES))
    for _ in range(data.draw(st.integers(1, 3))):
        value = changed(value, data.draw(st.sampled_from(places(value))), data.draw(VALUES))
    read_or_refused(lambda: annotations_from(json.dumps(value).encode(), FRAME))


@settings(max_examples=150, deadline=None)
@given(st.data())
def test_any_change_of_xml_is_read_or_refused(data: st.DataObject) -> None:
    texts = [CVAT_VIDEO, (FOREIGN / "cvat.xml").read_text(), (FOREIGN / "voc.xml").read_text()]
    texts.append((FOREIGN / "tools" / "datumaro_cvat_images.xml").read_text())
    text = data.draw(st.sampled_from(texts))
    quoted = re.findall(r'(?<==)"[^"]*"', text) or ["<name>dent</name>"]
    old = data.draw(st.sampled_from(quoted))
    new = data.draw(st.sampled_from(['""', '"-1"', '"1e999"', '"NaN"', '"a,b"', '"9999999999999"', '"1,2;3"']))
    read_or_refused(lambda: annotations_from(text.replace(old, new, 1).encode(), FRAME))


ARCHIVES = [path.read_bytes() for path in sorted(FOREIGN.rglob("*.zip"))]


@settings(max_examples=300, deadline=None)
@given(st.sampled_from(ARCHIVES), st.lists(st.tuples(st.integers(0, 1 << 16), st.binary(max_size=3)), max_size=4))
def test_any_change_of_an_archive_is_read_or_refused(archive: bytes, changes: list[tuple[int, bytes]]) -> None:
    damaged = bytearray(archive)
    for place, new in changes:
        at = len(damaged) - 1 - place % len(damaged)  # drawn small numbers are near the table of contents
        damaged[at : at + 2] = new
    read_or_refused(lambda: annotations_from(bytes(damaged), FRAME))


def read_or_refused(attempt: Callable[[], Annotations]) -> None:
    try:
        annotations, refusal = attempt(), None
    except BadInput as error:
        annotations, refusal = Annotations(), error
    assert refusal is None or (refusal.where and len(refusal.message) < 600)
    for detection in annotations.detections:
        x1, y1, x2, y2 = detection.box
        assert 0 <= x1 < x2 <= 1
        assert 0 <= y1 < y2 <= 1
