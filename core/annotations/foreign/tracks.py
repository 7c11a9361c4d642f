"""Keyframes of a box that somebody followed through a video, and the frames between them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

from core.annotations.checks import invalid
from core.annotations.foreign.sheet import MAX_SHAPES, Points
from core.geometry.boxes import Box


@dataclass(frozen=True)
class Keyframe:
    """Where a thing is at a frame."""

    frame: int
    box: Box
    rotation_deg: float = 0.0
    """Clockwise, about the middle of the box."""
    outline: Points | None = None
    follows: bool = True
    """Whether it is still there after this frame, up to the next keyframe."""
    there: bool = True
    """Whether it is there at this frame."""


def unfolded(keyframes: Sequence[Keyframe], step: int, end: int | None, where: str) -> Iterator[Keyframe]:
    """The thing at every frame at which it is there: boxes move linearly from keyframe to keyframe.

    An outline stays with its own keyframe; between two of as many corners the corners move linearly, too.

    Args:
        keyframes: in any order.
        step: between two frames that were shown to whoever drew them.
        end: last frame that was shown: a thing that does not end is there up to it; None = up to its last keyframe.
        where: for messages.

    Raises:
        BadInput: there are more frames than a file may hold.
    """
    ordered = sorted(keyframes, key=lambda one: one.frame)
    for i, one in enumerate(ordered):
        if one.there:
            yield one
        later = ordered[i + 1] if i + 1 < len(ordered) else None
        last = later.frame - 1 if later is not None else (end if end is not None else one.frame)
        if not one.follows:
            continue
        if (last - one.frame) // step > MAX_SHAPES:
            raise invalid(where, f"reaches over {last - one.frame} frames, more than {MAX_SHAPES}")
        for frame in range(one.frame + step, last + 1, step):
            yield replace(one if later is None else _between(one, later, frame), frame=frame)


def _between(one: Keyframe, later: Keyframe, frame: int) -> Keyframe:
    share = (frame - one.frame) / (later.frame - one.frame)
    x1, y1, x2, y2 = (a + share * (b - a) for a, b in zip(one.box, later.box, strict=True))
    turn = (later.rotation_deg - one.rotation_deg + 180) % 360 - 180
    outline = None
    if one.outline is not None and later.outline is not None and len(one.outline) == len(later.outline):
        ends = zip(one.outline, later.outline, strict=True)
        outline = tuple((xa + share * (xb - xa), ya + share * (yb - ya)) for (xa, ya), (xb, yb) in ends)
    return Keyframe(frame, (x1, y1, x2, y2), one.rotation_deg + share * turn, outline)


def turned(box: Box, degrees: float, about: tuple[float, float] | None = None) -> Points | None:
    """Corners of a box that is turned clockwise about its middle (or `about`); None when it is upright.

    Coordinates must be of one unit in both directions.
    """
    if math.isclose(math.remainder(degrees, 180), 0, abs_tol=1e-9) and about is None:
        return None
    x1, y1, x2, y2 = box
    cx, cy = about or ((x1 + x2) / 2, (y1 + y2) / 2)
    cos, sin = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
    corners = ((x1, y1), (x2, y1), (x2, y2), (x1, y2))
    return tuple((cx + cos * (x - cx) - sin * (y - cy), cy + sin * (x - cx) + cos * (y - cy)) for x, y in corners)
