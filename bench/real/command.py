"""`bladeatlas-bench real`: build clips from checkouts, run product and peer on them, print one table."""

from __future__ import annotations

import argparse
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

from bench.kept import Found, markdown_table
from bench.real.clip import REFERENCE, Clip, read_reference
from core.errors import BadInput

PART = ".part"
"""Ends the name of a clip that is being built."""

HEAD = (
    "clip",
    "frames",
    "by",
    "registered (+ in further models)",
    "position median / 95 %, % of the path's extent",
    "rotation median / 95 %, degrees",
    "focal length, % off",
    "depth median / 95 %, % off",
    "verdict",
    "CPU s to the sparse model",
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument("out", type=Path, metavar="OUT", help="folder of clips, runs and scores; it is gone on with")
    parser.add_argument(
        "--sources", type=Path, metavar="DIR", help="folder of checkouts, each by the name of its repository"
    )
    parser.add_argument("--only", metavar="CLIP,...", default="", help="these clips")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="option of the product's runs")
    parser.add_argument("--side", choices=("both", "peer", "product"), default="both", help="who runs (both)")
    parser.add_argument("--make", action="store_true", help="only build the clips")


def command(arguments: argparse.Namespace) -> None:
    """Build what is missing, run what is missing and print the table; standard error tells each run's end."""
    # Imported here so that --help does not load the vision libraries.
    from bench.real.measure import Bench

    clips = _clips(arguments.out / "clips", arguments.sources)
    if not clips:
        raise BadInput(
            f"there are no clips in {arguments.out / 'clips'}, and no checkout to build one of", where="--sources"
        )
    wanted = [name for name in arguments.only.split(",") if name] or sorted(clips)
    unknown = set(wanted) - set(clips)
    if unknown:
        text = f"there is no clip {', '.join(sorted(unknown))}; there are: {', '.join(sorted(clips)) or 'none'}"
        raise BadInput(text, where="--only")
    if arguments.make:
        return
    bench, lines = (
        Bench(arguments.out, {name: value for name, _, value in (item.partition("=") for item in arguments.set)}),
        [],
    )
    for name in wanted:
        reference = read_reference(clips[name].folder)
        for side in ("peer", "product") if arguments.side == "both" else (arguments.side,):
            found = bench.peer(clips[name], reference) if side == "peer" else bench.product(clips[name], reference)
            print(f"{name}, {side}: {found['cpu_s']:.0f} s", file=sys.stderr, flush=True)
            lines.append(cells(name, reference.n_frames, side, found))
    print(markdown_table(HEAD, lines))


def _clips(folder: Path, checkouts: Path | None) -> dict[str, Clip]:
    """Clips by name: those of the folder, and what can be built of the checkouts and is not there yet."""
    if checkouts is not None:
        _build(folder, checkouts)
    found = [path.parent for path in sorted(folder.glob(f"*/{REFERENCE}")) if path.parent.suffix != PART]
    return {path.name: Clip(path.name, path) for path in found}


def _build(folder: Path, checkouts: Path) -> None:
    """Build every clip that is not there yet, whole or not at all; say which checkouts are missing."""
    # Imported here so that --help does not load the vision libraries.
    from bench.real.sources import SOURCES

    for source in SOURCES:
        if (folder / source.name / REFERENCE).is_file():
            continue
        if not source.is_there(checkouts):
            print(f"{source.name}: no checkout of {source.repository} in {checkouts}", file=sys.stderr)
            continue
        work = folder / f"{source.name}{PART}"
        shutil.rmtree(work, ignore_errors=True)
        work.mkdir(parents=True)
        source.build(checkouts, work)
        work.rename(folder / source.name)


def cells(clip: str, n_frames: int, side: str, found: Found) -> list[str]:
    """One row of the table."""
    score = found["score"]
    further = f" (+ {score['elsewhere']})" if score["elsewhere"] else ""
    verdict = found.get("verdict", "-")
    flags = found.get("flags")
    return [
        clip,
        str(n_frames),
        "COLMAP" if side == "peer" else "BladeAtlas",
        f"{score['registered']}{further}",
        _spread(score["position_percent"], 2),
        _spread(score["rotation_deg"], 2),
        "-" if score["focal_percent"] is None else f"{score['focal_percent']:+.1f}",
        _spread(score["depth_percent"], 1),
        f"{verdict} ({', '.join(flags)})" if flags else str(verdict),
        f"{found['cpu_s']:.0f}",
    ]


def _spread(values: Sequence[float] | None, digits: int) -> str:
    return "-" if values is None else " / ".join(f"{value:.{digits}f}" for value in values)
