"""What a reader should know of how the time keys were read, in sentences, and what can be done about it."""

from __future__ import annotations

from core.annotations.checks import shown
from core.annotations.clocks import MEANINGS
from core.annotations.convention import Fitted
from core.annotations.reading import Reading


def advice(fitted: Fitted) -> list[str]:
    """One sentence for each doubt about the time keys; none for a file that leaves none, or whose reading is told."""
    if fitted.forced:
        return []
    one, said = fitted.reading, []
    if fitted.doubtful:
        said.append(_ambiguous(one, fitted.others))
    if one.blurred:
        said.append(
            f"the time keys have too few decimals to tell frames apart: {len(one.blurred)} of {len(one.frames)} may "
            f"mean a frame beside the one taken, such as {shown(one.blurred[0])}; write more decimals or frame numbers"
        )
    if one.strays:
        said.append(
            f"{len(one.strays)} of {len(one.frames)} time keys are no time of a frame, such as "
            f"{shown(one.strays[0])}; the nearest frame was taken"
        )
    if one.clock == "displayed":
        said.append(
            "the time keys are no times of frames by any reading; the frame on the screen was taken "
            "(input.time_convention can say what they mean)"
        )
    return said


def _ambiguous(taken: Reading, others: tuple[Reading, ...]) -> str:
    differing = [key for key in taken.frames if any(one.frames[key] != taken.frames[key] for one in others)]
    key = differing[-1]
    ways = [f"{one.clock} ({MEANINGS[one.clock]}: {_frame(one, key)})" for one in (taken, *others)]
    return (
        f"the time keys fit {len(ways)} readings that mean different frames, here of key {shown(key)}: "
        f"{', or '.join(ways)}. {taken.clock} was taken; set input.time_convention to the one that is meant"
    )


def _frame(one: Reading, key: str) -> str:
    frame = one.frames[key]
    return "outside the video" if frame is None else f"frame {frame}"
