"""Masks that are packed by the rules of other tools, unpacked again."""

from __future__ import annotations

import base64
import json
from itertools import groupby
from typing import Any

import cv2
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from core.annotations.foreign import coco
from core.annotations.foreign.bitmaps import (
    MAX_MASK_PX,
    Unreadable,
    coco_outlines,
    label_studio_outlines,
    outlines,
    png_outlines,
    row_outlines,
)
from core.annotations.foreign.sheet import MAX_PIXELS, Sheet
from core.annotations.masks import rasterise
from core.errors import BadInput
from core.scene.frame import Crop
from tests.inputs import INPUTS

TOOLS = INPUTS / "foreign" / "tools"


def runs_of(flat: NDArray[np.uint8]) -> list[int]:
    """Lengths of runs, the first of zeros."""
    found = [(int(value), len(list(group))) for value, group in groupby(flat.tolist())]
    return [length for _, length in ([(0, 0)] if found[0][0] else []) + found]


def compressed(runs: list[int]) -> str:
    """COCO's compression, written down from its description: five bits, lowest first, with a sign."""
    text = ""
    for i, run in enumerate(runs):
        value, more = run - (runs[i - 2] if i > 2 else 0), True
        while more:
            bits = value & 31
            value >>= 5
            more = value != (-1 if bits & 16 else 0)
            text += chr((bits | (32 if more else 0)) + 48)
    return text


MASKS = st.tuples(st.integers(3, 40), st.integers(3, 40), st.integers(0, 2**32 - 1)).map(
    lambda drawn: (np.random.default_rng(drawn[2]).random(drawn[:2]) < 0.4).astype(np.uint8)
)


@settings(deadline=None)
@given(MASKS)
def test_runs_by_columns_and_by_rows_give_the_outlines_of_the_mask(mask: NDArray[np.uint8]) -> None:
    height, width = mask.shape
    wanted = sorted(outlines(mask, (0, 0)))
    columns = runs_of(mask.T.reshape(-1))
    assert sorted(coco_outlines(columns, height, width)) == wanted
    assert sorted(coco_outlines(compressed(columns), height, width)) == wanted
    assert sorted(row_outlines(runs_of(mask.reshape(-1)), height, width, (0, 0))) == wanted


def test_the_compression_is_that_of_the_library_of_coco() -> None:
    document = json.loads((TOOLS / "datumaro_coco.json").read_text())
    (masked,) = [one for one in document["annotations"] if isinstance(one["segmentation"], dict)]
    counts = masked["segmentation"]["counts"]
    if isinstance(counts, list):
        counts = compressed(counts)
    (outline,) = coco_outlines(counts, 720, 960)
    assert {x for x, _ in outline} == {240.5, 359.5}
    assert {y for _, y in outline} == {360.5, 419.5}


def test_an_outline_fills_its_own_mask() -> None:
    mask = cv2.circle(np.zeros((60, 80), np.uint8), (40, 30), 20, 1, -1)
    (outline,) = outlines(np.asarray(mask, np.uint8), (0, 0))
    polygon = tuple((x / 80, y / 60) for x, y in outline)
    filled = rasterise([polygon], Crop(0, 0, 80, 60, 80, 60))
    assert np.array_equal(filled, mask.astype(bool))


def test_a_brush_of_label_studio_is_its_opacity() -> None:
    task = json.loads((TOOLS / "label_studio_images.json").read_text())[3]
    packed = task["annotations"][0]["result"][-1]["value"]["rle"]
    (outline,) = label_studio_outlines(packed, 720, 960)
    assert (min(outline), max(outline)) == ((240.5, 360.5), (359.5, 419.5))
    broken: list[list[Any]] = [packed[:-5], packed[:3], [*packed[:4], 0, *packed[5:]], ["a"]]
    for wrong in broken:
        with pytest.raises(Unreadable):
            label_studio_outlines(wrong, 720, 960)
    with pytest.raises(Unreadable):
        label_studio_outlines(packed, 720, 961)


@pytest.mark.parametrize("channels", [1, 3, 4])
def test_a_picture_shows_its_mask_by_opacity_or_brightness(channels: int) -> None:
    mask = np.zeros((10, 12), np.uint8)
    mask[2:6, 3:9] = 200
    picture = mask if channels == 1 else np.repeat(mask[..., None], channels, axis=2)
    if channels == 4:
        picture[..., :3] = 255
    text = base64.b64encode(cv2.imencode(".png", picture)[1].tobytes()).decode()
    (outline,) = png_outlines(text, (100, 50))
    assert (min(outline), max(outline)) == ((103.5, 52.5), (108.5, 55.5))


@pytest.mark.parametrize(
    ("counts", "height", "width"),
    [
        ("abc", 720, 960),
        ([1, 2], 2, 2),
        ([5, -1], 2, 2),
        ([4], 2, 0),
        ([MAX_MASK_PX + 1], 1, MAX_MASK_PX + 1),
        ("~", 2, 2),
        ("P" * 60, 2, 2),
        ([1.5, 2.5], 2, 2),
    ],
)
def test_what_is_no_mask_of_its_picture_is_not_unpacked(counts: str | list[int], height: int, width: int) -> None:
    with pytest.raises(Unreadable):
        coco_outlines(counts, height, width)


def test_noise_and_endless_masks_are_refused() -> None:
    noise = np.indices((1200, 2000)).sum(axis=0).astype(np.uint8) % 2
    with pytest.raises(Unreadable, match="noise"):
        outlines(noise, (0, 0))
    side = 1 << 12
    full = {"size": [side, side], "counts": [0, side * side]}
    image = {"id": 1, "file_name": "1.png", "width": side, "height": side}
    one = {"image_id": 1, "category_id": 1, "segmentation": full}
    sheet = Sheet(coco.DROPS)
    sheet.spend(MAX_PIXELS - side * side)
    document = {"images": [image], "annotations": [one], "categories": [{"id": 1, "name": "dent"}]}
    coco.read(document, "", sheet)
    with pytest.raises(BadInput, match="17 thousand million pixels"):
        coco.read(document, "", sheet)


def test_a_picture_is_measured_before_it_is_unpacked() -> None:
    header = b"\x89PNG\r\n\x1a\n" + bytes(8) + (1 << 15).to_bytes(4, "big") * 2
    with pytest.raises(Unreadable, match="32768x32768"):
        png_outlines(base64.b64encode(header).decode(), (0, 0))
    for text in ("%", base64.b64encode(b"x" * 40).decode()):
        with pytest.raises(Unreadable):
            png_outlines(text, (0, 0))
