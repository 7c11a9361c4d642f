"""What the commands that talk to a server accept."""

from __future__ import annotations

import argparse
from pathlib import Path

from cli.input_files import add_calibration, add_format, add_limits
from cli.recordings import add_recordings
from core.settings import PRESET_NAMES

Commands = argparse._SubParsersAction  # argparse has no public name for it
_KEY = "API key: from --key-file, or the variable of --key-env (BLADEATLAS_API_KEY)"


def add_remote_commands(commands: Commands[argparse.ArgumentParser], exit_codes: str) -> None:
    """Register submit, status, watch, download and cancel."""
    _submit(_add(commands, "submit", "send videos and annotations to a server and start an inspection", exit_codes))
    status = _add(commands, "status", "say how an inspection stands, or list the latest")
    status.add_argument("id", nargs="?", metavar="ID")
    status.add_argument("--state", metavar="STATE", help="list only these")
    status.add_argument("--limit", type=_count, default=20, metavar="N", help="list at most so many (20)")
    watch = _add(commands, "watch", "show an inspection until it is over", exit_codes)
    watch.add_argument("id", metavar="ID")
    download = _add(commands, "download", "fetch the files of an inspection; cut off, it goes on")
    download.add_argument("id", metavar="ID")
    download.add_argument("--out", type=Path, metavar="DIR", help="folder to fill (ID)")
    download.add_argument(
        "--include", action="append", default=[], metavar="GLOB", help="only paths of this pattern (repeatable)"
    )
    _add(commands, "cancel", "stop an inspection").add_argument("id", metavar="ID")


def _submit(submit: argparse.ArgumentParser) -> None:
    add_recordings(submit)
    add_format(submit)
    add_calibration(submit)
    add_limits(submit)
    submit.add_argument("--preset", metavar="|".join(PRESET_NAMES), help="where the values start")
    submit.add_argument(
        "--set", action="append", default=[], dest="assignments", metavar="NAME=VALUE", help="set one option"
    )
    submit.add_argument(
        "--parameters",
        type=Path,
        metavar="FILE",
        help="JSON {preset, options {name: value}, label, external_id, priority, metadata}",
    )
    submit.add_argument("--label", default="", metavar="TEXT", help="free text")
    submit.add_argument("--external-id", default="", metavar="TEXT", help="your own name for it")
    submit.add_argument("--priority", type=int, metavar="N", help="0 to 9; higher ones of your account go first (0)")
    submit.add_argument("--wait", action="store_true", help="show it until it is over")


def _add(
    commands: Commands[argparse.ArgumentParser], name: str, text: str, epilog: str | None = None
) -> argparse.ArgumentParser:
    command = commands.add_parser(name, help=text, description=text[0].upper() + text[1:] + ".", epilog=epilog)
    command.set_defaults(module="cli.remote", function=name)
    command.add_argument("--server", metavar="URL", help="address (BLADEATLAS_SERVER, or http://127.0.0.1:8000)")
    command.add_argument("--key-env", metavar="NAME", help=_KEY)
    command.add_argument("--key-file", type=Path, metavar="FILE", help="file that holds nothing but the key")
    command.add_argument("--json", action="store_true", help="print JSON lines")
    return command


def _count(text: str) -> int:
    number = int(text)
    if number < 1:
        raise argparse.ArgumentTypeError("at least 1")
    return number
