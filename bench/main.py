"""`bladeatlas-bench`: how right and how fast a result is, what the service survives, what the tests notice."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path

from bench import boards, inputs, measurements, verdicts
from bench.mutate import command as mutate
from bench.real import command as real
from bench.row import command as row
from bench.scenes import command as scenes
from bench.scenes import variants_command as variants
from bench.service import simulate
from bench.soak import command as soak
from bench.study import command as study
from bench.usability import command as usability
from core.errors import BadInput, BladeAtlasError


def _accuracy(arguments: argparse.Namespace) -> None:
    """Score a result folder against ground truth."""
    # Imported here so that --help does not load the vision libraries.
    from bench.accuracy.score import score_result
    from bench.accuracy.table import format_score

    score = score_result(arguments.result, arguments.truth)
    print(json.dumps(score, indent=1, allow_nan=False) if arguments.json else format_score(score))


def make_parser() -> argparse.ArgumentParser:
    """The command line; every subcommand sets `run`, a function of the parsed arguments."""
    parser = argparse.ArgumentParser(prog="bladeatlas-bench", description=__doc__)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    accuracy = commands.add_parser("accuracy", help="score a result folder against ground truth")
    accuracy.add_argument("result", type=Path, metavar="RESULT", help="output folder of `bladeatlas run`")
    accuracy.add_argument("truth", type=Path, metavar="TRUTH", help="folder of cameras.json, defects.json, surface.ply")
    accuracy.add_argument("--json", action="store_true", help="print JSON instead of a table")
    accuracy.set_defaults(run=_accuracy)
    speed_parser = commands.add_parser("speed", help="time the parts of a finished run beside other programs")
    measurements.add_speed_arguments(speed_parser)
    speed_parser.set_defaults(run=measurements.speed)
    soak_parser = commands.add_parser("soak", help="run jobs through a whole deployment while its processes are killed")
    soak.add_arguments(soak_parser)
    soak_parser.set_defaults(run=soak.command)
    service_parser = commands.add_parser("service", help="time uploads, downloads, many clients, and the queue")
    measurements.add_service_arguments(service_parser)
    service_parser.set_defaults(run=measurements.service)
    simulate_parser = commands.add_parser(
        "simulate", help="replay recorded inspections on many workers, by a set clock"
    )
    simulate.add_arguments(simulate_parser)
    simulate_parser.set_defaults(run=simulate.command)
    scenes_parser = commands.add_parser("scenes", help="render, run and score the scenes of the suite")
    scenes.add_arguments(scenes_parser)
    scenes_parser.set_defaults(run=scenes.command)
    row_parser = commands.add_parser("row", help="find the row of blades on true surfaces and in results, and score it")
    row.add_arguments(row_parser)
    row_parser.set_defaults(run=row.command)
    variants_parser = commands.add_parser("variants", help="run clips made from a clip: fewer frames, dark frames")
    variants.add_arguments(variants_parser)
    variants_parser.set_defaults(run=variants.command)
    verdicts_parser = commands.add_parser("verdicts", help="hold what results say of themselves against the truth")
    verdicts.add_arguments(verdicts_parser)
    verdicts_parser.set_defaults(run=verdicts.command)
    real_parser = commands.add_parser("real", help="run real clips with known cameras beside COLMAP")
    real.add_arguments(real_parser)
    real_parser.set_defaults(run=real.command)
    inputs_parser = commands.add_parser("inputs", help="probe an hour of video: memory and time")
    inputs.add_arguments(inputs_parser)
    inputs_parser.set_defaults(run=inputs.command)
    boards_parser = commands.add_parser("boards", help="render calibration boards through known lenses and calibrate")
    boards.add_arguments(boards_parser)
    boards_parser.set_defaults(run=boards.command)
    mutate_parser = commands.add_parser("mutate", help="change the code of an area and see whether its tests fail")
    mutate.add_arguments(mutate_parser)
    mutate_parser.set_defaults(run=mutate.command)
    usability_parser = commands.add_parser("usability", help="ask gallery, page and report what an inspector asks")
    usability.add_arguments(usability_parser)
    usability_parser.set_defaults(run=usability.command)
    study_parser = commands.add_parser("study", help="evaluate what people did in a study of `bladeatlas study`")
    study.add_arguments(study_parser)
    study_parser.set_defaults(run=study.command)
    return parser


def main(argv: Sequence[str] | None = None) -> int:
    """Run one subcommand; 0 done, 2 bad input, 1 any other expected error."""
    arguments = make_parser().parse_args(argv)
    try:
        arguments.run(arguments)
    except BladeAtlasError as error:
        print(f"error: {error.message}", file=sys.stderr)
        return 2 if isinstance(error, BadInput) else 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
