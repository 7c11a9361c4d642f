"""`bladeatlas point`: what a pixel of a frame shows."""

from __future__ import annotations

import argparse
import json

from core.errors import BadInput
from core.mapping.rows import REASONS


def command(parsed: argparse.Namespace) -> int:
    """Cast a pixel of a finished result onto its surface and say what is there."""
    # Loaded here: questions need the ray caster, `--help` does not.
    from core.query import Result

    result = Result(parsed.result, parsed.model)
    if parsed.frame is None and parsed.time is None:
        raise BadInput("say which frame: --frame N (of the video, from 0) or --time SECONDS", where="--frame")
    frame = result.frame_at(parsed.time) if parsed.frame is None else parsed.frame
    x, y = numbers(parsed.pixel, 2, "--pixel")
    shown = result.point_at(frame, x, y)
    if parsed.json:
        print(json.dumps({"schema_version": 1, "source_index": frame, **shown.to_dict()}, indent=1, allow_nan=False))
    elif shown.point is None:
        print(f"frame {frame} shows nothing there: {REASONS[str(shown.reason)]}")
    else:
        print(f"frame {frame}, pixel {x:g}, {y:g}")
        print(f"  point      {_three(shown.point)}  (model units)")
        print(f"  normal     {_three(shown.normal or (0.0, 0.0, 0.0))}")
        print(f"  distance   {shown.distance:.4f}, seen at {shown.incidence_deg:.0f} degrees")
        print(f"  defect     {'none' if shown.defect_id is None else f'D{shown.defect_id}'}")
    return 0


def numbers(text: str, count: int, where: str) -> list[float]:
    """Comma-separated numbers; `BadInput` when they are not as many as asked for."""
    try:
        values = [float(part) for part in text.split(",")]
    except ValueError:
        values = []
    if len(values) != count:
        raise BadInput(f"'{text}' is not {count} numbers separated by commas", where=where)
    return values


def _three(values: tuple[float, float, float]) -> str:
    return ", ".join(f"{value:.5f}" for value in values)
