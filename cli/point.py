"""`bladeatlas point`: what a pixel of a frame shows."""

from __future__ import annotations

import argparse
import math

from cli.terminal import say, say_json
from core.errors import BadInput
from core.scene.detection import REASONS


def command(parsed: argparse.Namespace) -> int:
    """Cast a pixel of a finished result onto its surface and say what is there."""
    # Loaded here: questions need the ray caster, `--help` does not.
    from core.query import Result

    if (parsed.frame is None) == (parsed.time is None):
        raise BadInput("say which frame: --frame N (of the video, from 0) or --time SECONDS, not both", where="--frame")
    x, y = numbers(parsed.pixel, 2, "--pixel")
    result = Result(parsed.result, parsed.model or 0)
    frame = result.frame_at(parsed.time) if parsed.frame is None else parsed.frame
    shown = result.point_at(frame, x, y)
    if parsed.json:
        say_json({"schema_version": 1, "source_index": frame, **shown.to_dict()}, indent=1)
    elif shown.point is None:
        say(f"frame {frame} shows nothing there: {'' if shown.reason is None else REASONS[shown.reason]}")
    else:
        say(
            f"frame {frame} at {shown.time_s:.3f} s, pixel {x:g}, {y:g}",
            f"  point      {three(shown.point)}  (model units)",
            f"  normal     {three(shown.normal or (0.0, 0.0, 0.0))}",
            f"  distance   {shown.distance:.4f}, seen at {shown.incidence_deg:.0f} degrees",
            f"  defect     {'none' if shown.defect_id is None else f'D{shown.defect_id}'}",
        )
    return 0


def numbers(text: str, count: int, where: str) -> list[float]:
    """Comma-separated finite numbers; `BadInput` when they are not as many as asked for."""
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if len(values) != count:
        raise BadInput(f"'{text}' is not {count} numbers separated by commas", where=where)
    if not all(math.isfinite(value) for value in values):
        raise BadInput(f"'{text}' holds a number that is not finite", where=where)
    return values


def three(values: tuple[float, float, float]) -> str:
    """A place for people."""
    return ", ".join(f"{value:.5f}" for value in values)
