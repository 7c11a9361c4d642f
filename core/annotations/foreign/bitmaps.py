"""Masks as other tools pack them, unpacked within limits and turned into outlines.

Sources: COCO's run lengths (cocodataset/cocoapi, common/maskApi.c, `rleFrString`), CVAT's (column "mask" of its XML
format), Label Studio's (the packing of thi.ng/rle-pack), PNG pictures in base64 (LabelMe, Supervisely).
"""

from __future__ import annotations

import base64
import binascii
import struct
import zlib
from collections.abc import Callable, Sequence

import cv2
import numpy as np
from numpy.typing import NDArray

from core.annotations.foreign.sheet import Points, Sheet

MAX_MASK_PX = 1 << 26
"""Pixels of one mask, at most: the picture of a large camera."""
MAX_RUNS = 1 << 22
"""Runs of one mask, at most."""
_MAX_PNG = 1 << 24
"""Bytes of one unpacked mask picture."""
_CHANNELS = 4
MAX_EDGES = 1 << 20
"""Pixels of a mask that differ from their left neighbour, at most: above it is noise, with as many outlines."""
_PNG = b"\x89PNG\r\n\x1a\n"


class Unreadable(ValueError):
    """A mask that cannot be unpacked; its box may serve."""


def largest(unpack: Callable[[], list[Points]], sheet: Sheet) -> Points:
    """The largest part that a mask holds; what is left of it, and a mask that cannot be unpacked, is counted.

    Args:
        unpack: gives the outlines of the parts, the largest first.
        sheet: whose table of drops has the kinds ``mask`` and ``part``.

    Returns:
        Corners in pixels; none for an empty mask.
    """
    try:
        parts = unpack()
    except Unreadable:
        sheet.drop("mask")
        return ()
    sheet.drop("part", max(0, len(parts) - 1))
    return parts[0] if parts else ()


def _free(pixels: int) -> None:
    """Let a mask of any number of pixels be unpacked."""


def coco_outlines(
    counts: str | Sequence[object], height: int, width: int, spend: Callable[[int], None] = _free
) -> list[Points]:
    """Outlines of COCO's run lengths, the largest first, in pixels.

    Args:
        counts: lengths of runs in the order of columns, the first of zeros; or the same compressed to a text.
        height: of the picture in pixels.
        width: of the picture in pixels.
        spend: is told how many pixels are going to be unpacked, and may refuse.

    Raises:
        Unreadable: the runs do not add up to the picture, or it is too large.
    """
    runs = np.asarray(_from_text(counts) if isinstance(counts, str) else _whole(counts), np.int64)
    _require(height, width, runs)
    ends = np.cumsum(runs)
    filled = np.flatnonzero(runs[1::2]) * 2 + 1
    if not filled.size:
        return []
    # Only the columns that hold something are unpacked: large pictures of small things are usual.
    first, last = int(ends[filled[0] - 1]) // height, (int(ends[filled[-1]]) - 1) // height
    spend((last - first + 1) * height)
    flat = np.zeros((last - first + 1) * height, np.uint8)
    for i in filled:
        flat[ends[i - 1] - first * height : ends[i] - first * height] = 1
    return outlines(np.ascontiguousarray(flat.reshape(-1, height).T), (first, 0))


def row_outlines(
    counts: Sequence[int],
    height: int,
    width: int,
    corner: tuple[float, float],
    spend: Callable[[int], None] = _free,
) -> list[Points]:
    """Outlines of run lengths in the order of rows, the first of zeros, whose picture's upper left pixel is `corner`.

    Raises:
        Unreadable: as of `coco_outlines`.
    """
    runs = np.asarray(_whole(counts), np.int64)
    _require(height, width, runs)
    spend(height * width)
    bits = np.zeros(len(runs), np.uint8)
    bits[1::2] = 1
    return outlines(np.repeat(bits, runs).reshape(height, width), corner)


def label_studio_outlines(
    packed: Sequence[object], height: int, width: int, spend: Callable[[int], None] = _free
) -> list[Points]:
    """Outlines of Label Studio's brush: packed values of red, green, blue and opacity by rows; opacity is the mask.

    Raises:
        Unreadable: the packed values are of another kind or size.
    """
    _require(height, width, None)
    content = [one for one in packed if isinstance(one, int) and 0 <= one <= 255]
    if len(content) != len(packed):
        raise Unreadable("no bytes")
    spend(height * width * _CHANNELS)
    values = _unpacked(bytes(content), height * width * _CHANNELS)
    return outlines((values[_CHANNELS - 1 :: _CHANNELS] > 0).astype(np.uint8).reshape(height, width), (0, 0))


def png_outlines(
    text: str, corner: tuple[float, float], spend: Callable[[int], None] = _free, *, packed: bool = False
) -> list[Points]:
    """Outlines of what a PNG picture in base64 shows (opaque, or not black), from its upper left pixel `corner` on.

    Args:
        text: the picture.
        corner: its place in pixels.
        spend: as of `coco_outlines`.
        packed: whether it is compressed once more, as Supervisely's is.

    Raises:
        Unreadable: it is no such picture, or too large.
    """
    try:
        data = base64.b64decode(text, validate=True)
        if packed:
            data = zlib.decompressobj().decompress(data, _MAX_PNG)
    except (binascii.Error, ValueError, zlib.error):
        raise Unreadable("no picture in base64") from None
    if not data.startswith(_PNG) or len(data) < 24:
        raise Unreadable("no PNG")
    width, height = struct.unpack(">II", data[16:24])
    _require(height, width, None)
    spend(height * width)
    picture = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
    if picture is None:
        raise Unreadable("a damaged picture")
    shown = picture if picture.ndim == 2 else picture[..., 3] if picture.shape[2] == 4 else picture.max(axis=2)
    return outlines((shown > 0).astype(np.uint8), corner)


def outlines(mask: NDArray[np.uint8], corner: tuple[float, float]) -> list[Points]:
    """Outer outlines of the parts of a (height, width) mask, the largest first.

    They run along the outer edges of the border pixels' centres: half a pixel is added, since positions here have
    the centre of the first pixel at 0.5.

    Raises:
        Unreadable: the mask has more edges than things have.
    """
    if np.count_nonzero(mask[:, 1:] != mask[:, :-1]) > MAX_EDGES:
        raise Unreadable("a mask of noise")
    found, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    ordered = sorted(found, key=cv2.contourArea, reverse=True)
    x0, y0 = corner
    return [
        tuple((float(x) + x0 + 0.5, float(y) + y0 + 0.5) for x, y in contour.reshape(-1, 2))
        for contour in ordered
        if len(contour) >= 3
    ]


def _require(height: int, width: int, runs: NDArray[np.int64] | None) -> None:
    if height < 1 or width < 1 or height * width > MAX_MASK_PX:
        raise Unreadable(f"a mask of {width}x{height} pixels")
    if runs is not None and ((runs < 0).any() or runs.max(initial=0) > MAX_MASK_PX or runs.sum() != height * width):
        raise Unreadable("runs that do not fill the picture")


def _whole(counts: Sequence[object]) -> Sequence[int]:
    whole = [one for one in counts[: MAX_RUNS + 1] if isinstance(one, int) and 0 <= one <= MAX_MASK_PX]
    if len(whole) > MAX_RUNS or len(whole) != len(counts):
        raise Unreadable("runs that are no whole numbers")
    return whole


def _from_text(text: str) -> list[int]:
    """COCO's compression: five bits a character, the sixth says that more follow; from the third on, differences."""
    runs: list[int] = []
    value, shift = 0, 0
    for char in text:
        bits = ord(char) - 48
        if not 0 <= bits < 64 or shift > 30 or len(runs) > MAX_RUNS:
            raise Unreadable("no compressed runs")
        value |= (bits & 31) << shift
        shift += 5
        if bits & 32:
            continue
        if bits & 16:
            value -= 1 << shift
        runs.append(value + runs[-2] if len(runs) > 2 else value)
        if abs(runs[-1]) > MAX_MASK_PX:
            raise Unreadable("no compressed runs")
        value, shift = 0, 0
    if shift:
        raise Unreadable("compressed runs that are cut off")
    return runs


def _unpacked(data: bytes, wanted: int) -> NDArray[np.uint8]:
    """The values of a packed byte stream: 32 bits their number, 5 bits their width, four times 4 bits the widths of
    run lengths; then runs, each with a bit that says whether one value follows or as many as the run is long."""
    bits = np.unpackbits(np.frombuffer(data, np.uint8))
    if len(bits) < 53 or _number(bits, 0, 32) != wanted or _number(bits, 32, 5) + 1 != 8:
        raise Unreadable("packed values of another size")
    sizes = [_number(bits, 37 + 4 * i, 4) + 1 for i in range(4)]
    out = np.zeros(wanted, np.uint8)
    at, i = 53, 0
    while i < wanted:
        same, which = _number(bits, at, 1), _number(bits, at + 1, 2)
        length = _number(bits, at + 3, sizes[which]) + 1
        at += 3 + sizes[which]
        if i + length > wanted:
            raise Unreadable("packed values that are too many")
        n = 1 if same else length
        if at + 8 * n > len(bits):
            raise Unreadable("packed values that are cut off")
        out[i : i + length] = np.packbits(bits[at : at + 8 * n])
        at += 8 * n
        i += length
    return out


def _number(bits: NDArray[np.uint8], start: int, count: int) -> int:
    value = 0
    for bit in bits[start : start + count].tolist():
        value = value * 2 + bit
    return value
