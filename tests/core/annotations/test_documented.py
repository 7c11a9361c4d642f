"""The page on annotations says what the code reads and refuses (docs/annotations.md)."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from core.annotations.foreign.archive import MAX_FILES
from core.annotations.foreign.formats import FORMATS, Format
from core.annotations.foreign.sheet import plural
from core.annotations.parse import MIN_MASK_IOU, parse_annotations
from core.annotations.placed import MAX_OUTSIDE_SHARE
from core.annotations.read import MAX_BYTES, parse_json
from core.errors import BadInput

PAGE = (Path(__file__).parents[3] / "docs" / "annotations.md").read_text(encoding="utf-8")
MISTAKES = re.findall(r"^\| `(.*)` \| `((?:annotations: |key |the annotations are).*)` \|$", PAGE, re.MULTILINE)


def format_row(form: Format) -> str:
    """The row of the page about a format of another tool."""
    left_out = ", ".join(plural(what) for what in form.drops.values())
    return f"| {form.title} (`{form.name}`) | {form.reads} | {left_out} | {form.frames} |"


def test_the_table_of_formats_is_that_of_the_readers() -> None:
    table = PAGE.partition("## Files of other tools")[2].partition("## Members")[0]
    rows = [line for line in table.splitlines() if line.startswith("| ")]
    assert rows[2:] == [format_row(form) for form in FORMATS]
    assert f"{MAX_FILES:,} files" in table


def test_the_example_is_read() -> None:
    example = re.search(r"```json\n(.*?)```", PAGE, re.DOTALL)
    assert example is not None
    first, second = parse_annotations(parse_json(example[1].encode())).entries
    (detection,) = first.detections
    assert (detection.label, detection.track_id, len(detection.polygon or ())) == ("dent", 7, 3)
    assert [mask.label for mask in first.masks] == ["blade"]
    assert second.detections == ()
    assert second.masks == ()


@pytest.mark.parametrize(("written", "message"), MISTAKES)
def test_a_mistake_has_the_message_that_is_documented(written: str, message: str) -> None:
    whole = written.startswith("{")
    valid = '"label": "dent", "bbox": [0.41, 0.38, 0.47, 0.44]'
    members = written if whole else ", ".join(one for one in (_without(valid, written), written) if one)
    text = members if whole else f'{{"12.5": {{"detections": [{{{members}}}]}}}}'
    with pytest.raises(BadInput) as caught:
        parse_annotations(parse_json(text.encode()))
    assert caught.value.message == message


def _without(valid: str, written: str) -> str:
    """The members of a valid detection, without the one that is written."""
    name = written.partition(":")[0]
    return ", ".join(part for part in re.split(r", (?=\")", valid) if not part.startswith(name))


def test_every_row_of_the_page_was_tried() -> None:
    table = PAGE.partition("## Common mistakes")[2]
    assert len(MISTAKES) == len(re.findall(r"^\| `", table, re.MULTILINE)) >= 10


def test_the_limits_are_the_codes() -> None:
    assert f"at least {MIN_MASK_IOU:g}" in PAGE.replace("\n  ", " ")
    assert f"at most {MAX_BYTES >> 20} MiB" in PAGE
    assert MAX_OUTSIDE_SHARE == 0.5, "the page says: more than half of the keys"
