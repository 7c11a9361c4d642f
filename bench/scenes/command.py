"""`bladeatlas-bench scenes`: render, run and score scenes, resumable, and print the table."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from bench.kept import markdown_table
from bench.scenes.suite import FAMILIES
from core.errors import BadInput


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument("out", type=Path, metavar="OUT", help="folder of scenes and scores; it is gone on with")
    parser.add_argument("--family", choices=sorted(FAMILIES), default="suite", help="which scenes (suite)")
    parser.add_argument("--only", metavar="NAME,...", default="", help="of these names")
    parser.add_argument("--thesis", action="store_true", help="by the preset thesis, with auto matching and 4 sources")
    parser.add_argument("--set", action="append", default=[], metavar="NAME=VALUE", help="option of the runs")
    parser.add_argument("--keep", action="store_true", help="keep the result folders")
    parser.add_argument(
        "--reuse", action="store_true", help="go on in kept result folders; no time is told where one was there"
    )
    parser.add_argument("--fit", action="store_true", help="fit the confidence on the kept runs of the family")
    parser.add_argument(
        "--lens",
        metavar="SEED,...",
        help="only find the lens with each of these seeds, against the true one",
    )
    parser.add_argument("--make", action="store_true", help="only render")


def command(arguments: argparse.Namespace) -> None:
    """Run what is missing and print the table; a line on standard error tells each scene's end."""
    # Imported here so that --help does not load the vision libraries.
    from bench.scenes.make import make_missing
    from bench.scenes.pooled import confidence_line, false_boxes_line, hard_half
    from bench.scenes.run import DEFAULT, THESIS, Bench, Column
    from bench.scenes.table import markdown

    family = FAMILIES[arguments.family]
    wanted = [name for name in arguments.only.split(",") if name] or [scene.name for scene in family]
    unknown = set(wanted) - {scene.name for scene in family}
    if unknown:
        raise BadInput(f"no scene is called {', '.join(sorted(unknown))}", where="--only")
    scenes = [scene for scene in family if scene.name in wanted]
    if arguments.make:
        for scene in scenes:
            make_missing(scene, arguments.out / "scenes" / scene.name)
        return
    if arguments.fit:
        from bench.scenes.fit import collect, report

        kept = [scene.name for scene in scenes if (arguments.out / "runs" / "default" / scene.name).is_dir()]
        print(report([collect(arguments.out, name) for name in kept]))
        return
    options = dict(item.split("=", 1) for item in arguments.set)
    column = THESIS if arguments.thesis else DEFAULT
    if options:
        column = Column(f"{column.name}-set", column.preset, {**column.options, **options})
    if arguments.lens is not None:
        from bench.scenes.lens import LENS_HEAD, find_lens, lens_cells

        seeds = [_seed(text) for text in arguments.lens.split(",")]
        lenses = [find_lens(arguments.out, scene, column, seed) for scene in scenes for seed in seeds]
        print(markdown_table(LENS_HEAD, [lens_cells(one) for one in lenses]))
        return
    bench, found = Bench(arguments.out, arguments.keep, arguments.reuse), []
    for scene in scenes:
        found.append(bench.score(scene, column))
        taken = "gone on with" if found[-1]["seconds"] is None else f"{found[-1]['seconds']:.0f} s"
        print(f"{scene.name}: {found[-1]['verdict']}, {taken}", file=sys.stderr, flush=True)
    print(markdown(scenes, found))
    can = [one for scene, one in zip(scenes, found, strict=True) if scene.expect == "mapped"]
    if not can:
        return
    print("\n" + confidence_line("confidence", can) + "\n" + false_boxes_line(can))
    thesis = {scene.name: bench.known(scene, THESIS) for scene in scenes if scene.expect == "mapped"}
    if column is DEFAULT and all(thesis.values()):
        names = hard_half(scenes, thesis)
        hard = [one for one in can if one["scene"] in names]
        print(confidence_line(f"hard half by the thesis's column ({', '.join(names)})", hard))


def _seed(text: str) -> int:
    try:
        return int(text)
    except ValueError:
        raise BadInput(f"'{text}' is no whole number", where="--lens") from None
