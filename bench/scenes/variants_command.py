"""`bladeatlas-bench variants`: clips made from a clip, run and put beside each other."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from bench.kept import Found, markdown_table
from core.errors import BadInput

RATES_HEAD = (
    "read",
    "frames",
    "registered",
    "focal length",
    "against the whole",
    "cameras median / 95 %, mm",
    "verdict",
)
DARK_HEAD = (
    "dark frames",
    "light",
    "models",
    "registered in the largest",
    "mapped",
    "wrong",
    "defects found / split / extra",
    "verdict",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    kinds = parser.add_subparsers(required=True, metavar="KIND")
    rates = kinds.add_parser("rates", help="one slow path rendered at 60 frames/s, whole and every 4th and 12th frame")
    rates.add_argument("out", type=Path, metavar="OUT", help="folder of clips, runs and scores; it is gone on with")
    rates.set_defaults(kind=_rates)
    dark = kinds.add_parser("dark", help="a clip with truth whose middle frames have hardly any light")
    dark.add_argument("out", type=Path, metavar="OUT", help="folder of clips, runs and scores; it is gone on with")
    dark.add_argument("source", type=Path, metavar="SOURCE", help="folder of video.mp4, annotations.json and truth")
    dark.add_argument("--frames", default="2,5,8,15", metavar="N,...", help="how many are dark (2,5,8,15)")
    dark.add_argument("--light", default="0,1,2,5", metavar="P,...", help="percent of the light left (0,1,2,5)")
    dark.set_defaults(kind=_dark)


def command(arguments: argparse.Namespace) -> None:
    """Make and run what is missing, and print the table of a kind."""
    print(arguments.kind(arguments))


def _rates(arguments: argparse.Namespace) -> str:
    # Imported here so that --help does not load the vision libraries.
    from bench.scenes.variants import rates

    found = rates(arguments.out)
    return markdown_table(RATES_HEAD, [rate_cells(one, found[0]) for one in found])


def _dark(arguments: argparse.Namespace) -> str:
    from bench.scenes.variants import dark_stretches

    counts = [round(value) for value in _numbers(arguments.frames, "--frames")]
    percents = _numbers(arguments.light, "--light")
    if min(counts) < 1 or min(percents) < 0 or max(percents) > 100:
        raise BadInput("at least one frame, and 0 to 100 percent of the light", where="--frames")
    return markdown_table(
        DARK_HEAD, [dark_cells(one) for one in dark_stretches(arguments.out, arguments.source, counts, percents)]
    )


def _numbers(text: str, where: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise BadInput(f"'{text}' is not a list of numbers", where=where) from None


def rate_cells(one: Found, whole: Found) -> list[str]:
    """A row of the table of rates."""
    frames, cameras = one["score"]["frames"], one["score"]["cameras"]
    focal, first = one["focal_px"], whole["focal_px"]
    share = frames["registered_share"] - whole["score"]["frames"]["registered_share"]
    lens = "-" if focal is None or first is None else f"{100 * (focal / first - 1):+.1f} %"
    return [
        "whole" if one["step"] == 1 else f"every {one['step']}th frame",
        str(frames["source_frames"]),
        f"{100 * frames['registered_share']:.1f} %",
        "-" if focal is None else f"{focal:.1f} px",
        f"registered {100 * share:+.1f} %, focal length {lens}",
        "-" if cameras is None else f"{cameras['position_median_mm']:.2f} / {cameras['position_p95_mm']:.2f}",
        _verdict(one),
    ]


def dark_cells(one: Found) -> list[str]:
    """A row of the table of dark stretches."""
    score = one["score"]
    place, defects, frames = score["placement"], score["defects"], score["frames"]
    return [
        str(one["frames"]),
        f"{one['percent']:g} %",
        str(bool(frames["registered"]) + len(score["models"])),
        f"{frames['registered']} of {frames['source_frames']}",
        f"{place['mapped_placeable']} of {place['placeable']}",
        str(place["wrong_mapped"]),
        f"{defects['found']} of {defects['expected']} / {defects['split']} / {defects['extra']}",
        _verdict(one),
    ]


def _verdict(one: Found) -> str:
    flags: Sequence[str] = one["flags"]
    return f"{one['verdict']} ({', '.join(flags)})" if flags else str(one["verdict"])
