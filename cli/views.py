"""`bladeatlas views`: which frames see a point of the surface, or a defect."""

from __future__ import annotations

import argparse
import json

import numpy as np

from cli.point import numbers
from core.errors import BadInput


def command(parsed: argparse.Namespace) -> int:
    """List the frames that see a place, best first."""
    # Loaded here: questions need the ray caster, `--help` does not.
    from core.query import Result, defect_place

    if (parsed.point is None) == (parsed.defect is None):
        raise BadInput("say which place: --point X,Y,Z in model units, or --defect ID", where="--point")
    place = (
        defect_place(parsed.result, parsed.defect)
        if parsed.point is None
        else np.array(numbers(parsed.point, 3, "--point"))
    )
    seeing = Result(parsed.result, parsed.model).frames_seeing(place)
    shown = seeing[: parsed.limit]
    if parsed.json:
        rows = [one.to_dict() for one in shown]
        print(json.dumps({"schema_version": 1, "n_frames": len(seeing), "frames": rows}, indent=1, allow_nan=False))
        return 0
    print(f"{len(seeing)} frames see it" + (f"; the best {len(shown)}:" if len(shown) < len(seeing) else ""))
    for one in shown:
        at = f"at {one.x:7.1f}, {one.y:7.1f} px"
        print(f"  frame {one.source_index:6d}  {one.time_s:9.3f} s  {at}  quality {one.quality:.2f}")
    return 0
