"""`bladeatlas point` and `views`: what a pixel of a frame shows, and which frames see a place or a defect."""

from __future__ import annotations

import argparse
import math
import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cli.terminal import say, say_json
from core.errors import BadInput
from core.scene.detection import REASONS, Reason

_DEFECT = re.compile(r"[dD]?([0-9]{1,9})")


def point(parsed: argparse.Namespace) -> int:
    """Cast a pixel of a finished result onto its surface and say what is there."""
    # Loaded here: questions need the ray caster, `--help` does not.
    from core.query import Result

    if (parsed.frame is None) == (parsed.time is None):
        raise BadInput("say which frame: --frame N (of the video, from 0) or --time SECONDS, not both", where="--frame")
    x, y = numbers(parsed.pixel, 2, "--pixel")
    result = Result(parsed.result, parsed.model or 0)
    frame = result.frame_at(parsed.time, parsed.video) if parsed.frame is None else parsed.frame
    shown = result.point_at(frame, x, y, parsed.video)
    which = f"video {parsed.video}, frame {frame}" if result.n_videos > 1 else f"frame {frame}"
    if parsed.json:
        say_json({"schema_version": 1, "video": parsed.video, "source_index": frame, **shown.to_dict()}, indent=1)
    elif shown.point is None:
        say(f"{which} shows nothing there: {REASONS[Reason(str(shown.reason))]}")
    else:
        say(
            f"{which} at {shown.time_s:.3f} s, pixel {x:g}, {y:g}",
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


def views(parsed: argparse.Namespace) -> int:
    """List the frames that see a place, best first."""
    # Loaded here: questions need the ray caster, `--help` does not.
    from core.query import Result

    if (parsed.point is None) == (parsed.defect is None):
        raise BadInput("say which place: --point X,Y,Z in model units, or --defect ID, not both", where="--point")
    if parsed.limit < 1:
        raise BadInput(f"{parsed.limit} frames; at least 1", where="--limit")
    place, model = _place(parsed.result, parsed.point, parsed.defect, parsed.model)
    result = Result(parsed.result, model)
    on = result.on_surface(place)
    visible = result.visible_frames(place, parsed.video)
    shown = visible[: parsed.limit]
    if parsed.json:
        rows = [one.to_dict() for one in shown]
        say_json({"schema_version": 1, **on.to_dict(), "n_frames": len(visible), "frames": rows}, indent=1)
        return 0
    if on.distance > on.spacing:
        off = f"{on.distance:.5f} from the place asked for (the surface's points lie {on.spacing:.5f} apart)"
        say(f"the nearest point of the surface is {three(on.point)}: {off}")
    say(f"{len(visible)} frames see it" + (f"; the best {len(shown)}:" if len(shown) < len(visible) else ""))
    for one in shown:
        at = f"at {one.x:7.1f}, {one.y:7.1f} px"
        which = f"video {one.video}  " if result.n_videos > 1 else ""
        say(f"  {which}frame {one.source_index:6d}  {one.time_s:9.3f} s  {at}  quality {one.quality:.2f}")
    return 0


def _place(folder: Path, point: str | None, defect: str | None, model: int | None) -> tuple[NDArray[np.float64], int]:
    """The place that was asked for, and the model in whose frame it is."""
    from core.query import defect_place

    if point is not None:
        return np.array(numbers(point, 3, "--point")), model or 0
    found = _DEFECT.fullmatch(defect or "")
    if found is None:
        raise BadInput(f"'{defect}' is no defect: write D1 or 1", where="--defect")
    return defect_place(folder, int(found[1]), model)
