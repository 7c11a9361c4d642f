"""Every command with its arguments; argparse, with negative numbers as values and errors of one line."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NoReturn

from cli.account_arguments import add_account_commands
from cli.input_files import add_calibration, add_format, add_limits
from cli.recordings import add_recordings
from cli.remote_arguments import add_remote_commands
from cli.terminal import say
from core.settings import PRESET_NAMES

_NEGATIVE = re.compile(r"-(\d|\.\d|inf|nan)", re.IGNORECASE)
_BAD_USAGE = 2
_EXIT_CODES = (
    "exit codes: 0 done, 1 internal error, 2 bad input or parameters, 3 no reconstruction, 4 partial, 130 interrupted"
)
_SHARED = {
    "probe": ("probe", "probe"),
    "check": ("inputs", "check"),
    "point": ("query", "point"),
    "views": ("query", "views"),
    "report": ("inspection_report", "command"),
}
"""Module and function of commands that share a module; any other is `command` in the module of its name."""


class Parser(argparse.ArgumentParser):
    """A parser whose subcommands are parsers of the same kind."""

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:  # the base class has overloads
        """Parse, with `--point -3.6,0.5,12.7` read as `--point=-3.6,0.5,12.7`."""
        return super().parse_known_args(with_negative_values(sys.argv[1:] if args is None else args), namespace)

    def error(self, message: str) -> NoReturn:
        """Say what is wrong in one line and exit with the code of bad input."""
        say(f"bladeatlas: {message} (see {self.prog} --help)", error=True)
        self.exit(_BAD_USAGE)


def with_negative_values(args: Sequence[str]) -> list[str]:
    """The arguments, each negative number or list of numbers joined with the option before it.

    Alone, argparse takes all but a single plain negative number for an option.
    """
    joined: list[str] = []
    for word in args:
        option = joined[-1] if joined else ""
        if _NEGATIVE.match(word) and option.startswith("--") and option != "--" and "=" not in option:
            joined[-1] = f"{option}={word}"
        else:
            joined.append(word)
    return joined


def parser() -> argparse.ArgumentParser:
    """The whole command; every subcommand sets the `module` and the `function` that run it."""
    top = _top()
    top.add_argument("--traceback", action="store_true", help="show where an internal error came from")
    commands = top.add_subparsers(required=True, metavar="COMMAND")
    _run(commands)
    _serve(commands)
    probe = _add(commands, "probe", "say what a video is: size, frames, times, damage")
    probe.add_argument("videos", type=Path, nargs="+", metavar="VIDEO")
    probe.add_argument("--stream", type=int, metavar="N", help="of several video streams; as input.video_stream")
    _fps(probe)
    _json(probe)
    check = _add(commands, "check", "say what was understood of an annotation file")
    check.add_argument(
        "files",
        type=Path,
        nargs="+",
        metavar="ANNOTATIONS [VIDEO]",
        help="an annotation file, and the video with whose frames its times are matched; or several such pairs",
    )
    _fps(check)
    add_format(check)
    _set(check, "set one option of the input (repeatable), e.g. input.time_convention=index to try a reading")
    _json(check)
    _convert(commands)
    _calibrate(commands)
    _questions(commands)
    options = _add(commands, "options", "list every option: meaning, unit, default, range, source")
    _preset(options)
    _json(options)
    _json(_add(commands, "version", "print the versions of this program and of the engines it uses"))
    add_remote_commands(commands, _EXIT_CODES)
    add_account_commands(commands)
    return top


def _top() -> argparse.ArgumentParser:
    return Parser(
        prog="bladeatlas",
        description="Borescope video and its annotations in, a 3D surface of the blades with every defect on it out.",
        epilog=_EXIT_CODES,
    )


def _convert(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    convert = _add(commands, "convert", "write the annotations of another tool in our own form")
    convert.add_argument("annotations", type=Path, metavar="ANNOTATIONS", help="file or folder of any format read")
    convert.add_argument("video", type=Path, nargs="?", metavar="VIDEO", help="the video they are of: times get exact")
    convert.add_argument("--out", type=Path, required=True, metavar="FILE", help="JSON to write")
    add_format(convert)
    _set(convert, "set one option of the input (repeatable)")
    _json(convert)


def _calibrate(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    calibrate = _add(commands, "calibrate", "find the lens from a video of a calibration board, for --calibration")
    calibrate.add_argument("video", type=Path, metavar="VIDEO", help="file, or folder or zip of pictures")
    calibrate.add_argument(
        "--board",
        required=True,
        metavar="BOARD",
        help="chessboard:9x6:10 (inner corners, side of a square) or charuco:11x8:15:11:DICT_5X5_100 (squares, side of "
        "a square and of a marker, OpenCV's dictionary)",
    )
    calibrate.add_argument("--out", type=Path, required=True, metavar="FILE", help="YAML to write")
    calibrate.add_argument("--model", choices=["fisheye", "pinhole"], default="fisheye", help="kind of lens (fisheye)")
    calibrate.add_argument("--views", type=int, default=40, metavar="N", help="views used, at most (40)")
    _json(calibrate)


def _questions(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    """What can be asked of a finished result."""
    point = _add(commands, "point", "say which point of the surface a pixel of a frame shows")
    point.add_argument("--frame", type=int, metavar="N", help="frame of the video, from 0")
    point.add_argument("--time", type=float, metavar="SECONDS", help="or the used frame nearest to this time")
    point.add_argument("--video", type=int, default=0, metavar="N", help="of several videos, from 0 (0)")
    point.add_argument(
        "--pixel", required=True, metavar="X,Y", help="pixels from the upper left corner of the whole frame"
    )
    views = _add(commands, "views", "list the frames that see a point of the surface, best first")
    views.add_argument("--point", metavar="X,Y,Z", help="in model units")
    views.add_argument("--defect", metavar="ID", help="or the place of a defect: D1, or 1")
    views.add_argument("--video", type=int, metavar="N", help="of several videos, only frames of this one, from 0")
    views.add_argument("--limit", type=int, default=20, metavar="N", help="frames listed, at most (20)")
    row = _add(commands, "row", "find the row of blades of a result; write row.json, its map and columns into it")
    row.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="NAME=VALUE",
        help="what is known of the row: count, zero_blade, direction, edge_a, radius_mm, same_blade (options row.*)",
    )
    add_limits(row)
    row.add_argument("result", type=Path, metavar="RESULT", help="output folder of `bladeatlas run`")
    row.add_argument("--json", action="store_true", help="print row.json")
    review = _add(commands, "review", "say what people say of the findings of a result; add records of a review.json")
    review.add_argument("result", type=Path, metavar="RESULT", help="output folder of `bladeatlas run`")
    review.add_argument(
        "--apply",
        type=Path,
        action="append",
        default=[],
        metavar="FILE",
        help="records that the page saved or a service gave, added to review.json of RESULT; those known are left",
    )
    form = review.add_mutually_exclusive_group()
    _json(form)
    form.add_argument("--csv", action="store_true", help="print the findings as CSV, machine and people side by side")
    view = _add(commands, "view", "open a result in the browser: findings, surface, frames, timeline")
    view.add_argument("result", type=Path, metavar="RESULT", help="output folder of `bladeatlas run`")
    view.add_argument("--no-browser", dest="browser", action="store_false", help="only print the address")
    view.add_argument("--port", type=int, default=0, metavar="N", help="port of this machine to serve at (a free one)")
    view.add_argument(
        "--video",
        type=Path,
        action="append",
        default=[],
        metavar="FILE",
        help="video of a result that keeps no pictures, of several each in their order: builds the page again",
    )
    _report(commands)
    _study(commands)
    for one in (point, views):
        one.add_argument("result", type=Path, metavar="RESULT", help="output folder of `bladeatlas run`")
        one.add_argument("--model", type=int, metavar="N", help="of several models (0, or the defect's)")
        _json(one)


def _report(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    report = _add(commands, "report", "write the report of a result for people: PDF, HTML, CSV, JSON")
    report.add_argument("result", type=Path, metavar="RESULT", help="output folder of `bladeatlas run`")
    report.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="folder of the report, made when missing"
    )
    report.add_argument(
        "--form", action="append", default=[], metavar="pdf|html|csv|json", help="only this form (repeatable)"
    )
    add_limits(report)
    report.add_argument(
        "--units", choices=["mm", "in"], default="mm", help="unit of the lengths shown where a scale is known (mm)"
    )
    report.add_argument("--style", type=Path, metavar="DIR", help="folder of the house style (docs/report.md)")
    report.add_argument("--reviewer", metavar="NAME", help="who signs (the person of the review, where it is one)")
    report.add_argument("--date", metavar="YYYY-MM-DD", help="day of the report (that of the last word of the review)")
    _json(report, "print the paths as JSON")


def _study(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    study = _add(commands, "study", "write a study that asks people about two results, with the gallery and the page")
    study.add_argument("first", type=Path, metavar="RESULT_A", help="output folder of `bladeatlas run`: scene A")
    study.add_argument("second", type=Path, metavar="RESULT_B", help="another one: scene B")
    study.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder of the study, made when missing")
    study.add_argument("--practice", type=Path, metavar="RESULT", help="a third one to look around in before the clock")
    study.add_argument("--contact", default="", metavar="TEXT", help="who answers questions, shown with the consent")
    _json(study, "print the paths as JSON")


def _run(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    run = _add(commands, "run", "inspect: videos and their annotations in, result folder out", epilog=_EXIT_CODES)
    add_recordings(run)
    add_format(run)
    add_calibration(run)
    add_limits(run)
    run.add_argument("--out", type=Path, required=True, metavar="DIR", help="result folder, made when missing")
    _preset(run, default=None)
    _set(run, "set one option (repeatable); `bladeatlas options` lists them")
    run.add_argument(
        "--parameters",
        type=Path,
        metavar="FILE",
        help="JSON {preset, options {name: value}, label, external_id, priority, metadata}",
    )
    run.add_argument(
        "--roi", metavar="full|X0,Y0,X1,Y1", help="region of interest, as shares of the source frame's width and height"
    )
    _fps(run)
    run.add_argument("--allow-truncated", action="store_true", help="use the decodable part of a damaged video")
    run.add_argument("--seed", type=int, metavar="N", help="seed of every random choice (0)")
    run.add_argument("--workers", type=int, metavar="N", help="processes side by side (number of cores)")
    run.add_argument("--from", dest="from_stage", metavar="STAGE", help="compute this stage and what follows again")
    run.add_argument("--force", action="store_true", help="replace another input's result in DIR")
    _json(run, "print progress and result as JSON lines")


def _serve(commands: argparse._SubParsersAction[argparse.ArgumentParser]) -> None:
    settings = "Settings are read from BLADEATLAS_* variables; see docs/operations/deploying.md."
    serve = _add(commands, "serve", "serve HTTP, and run tasks unless a broker is configured", epilog=settings)
    serve.add_argument("--host", default="127.0.0.1", help="address to bind to (127.0.0.1); others need an API key")
    serve.add_argument("--port", type=int, default=8000, help="port to bind to (8000)")
    serve.add_argument("--workers", type=int, metavar="N", help="tasks side by side (number of cores)")
    serve.add_argument(
        "--root-path", metavar="/PATH", help="the path that a proxy before the server takes off (BLADEATLAS_ROOT_PATH)"
    )
    serve.add_argument(
        "--no-auth", action="store_true", help="let whoever reaches the server read and submit without a key"
    )
    worker = _add(commands, "worker", "run tasks of a distributed system until stopped", epilog=settings)
    worker.add_argument("--queues", default="cpu,gpu", metavar="cpu,gpu", help="kinds of tasks to run (both)")
    worker.add_argument("--workers", type=int, metavar="N", help="tasks side by side (number of cores)")
    worker.add_argument("--check", action="store_true", help="only say whether a worker of this host is alive")
    _add(commands, "init", "bring tables and artifact store up and, once, print the first API key", epilog=settings)


def _add(
    commands: argparse._SubParsersAction[argparse.ArgumentParser], name: str, text: str, epilog: str | None = None
) -> argparse.ArgumentParser:
    command = commands.add_parser(name, help=text, description=text[0].upper() + text[1:] + ".", epilog=epilog)
    module, function = _SHARED.get(name, (name, "command"))
    command.set_defaults(module=f"cli.{module}", function=function)
    return command


def _preset(command: argparse.ArgumentParser, default: str | None = "default") -> None:
    command.add_argument("--preset", default=default, metavar="|".join(PRESET_NAMES), help="where the values start")


def _set(command: argparse.ArgumentParser, text: str) -> None:
    command.add_argument("--set", action="append", default=[], dest="assignments", metavar="NAME=VALUE", help=text)


def _fps(command: argparse.ArgumentParser) -> None:
    text = "frames per second of a video without times (pictures, a raw stream); as input.fps"
    command.add_argument("--fps", type=float, metavar="N", help=text)


def _json(command: argparse._ActionsContainer, text: str = "print JSON") -> None:
    command.add_argument("--json", action="store_true", help=text)
