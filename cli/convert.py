"""`bladeatlas convert`: annotations of any readable format, written in our own form."""

from __future__ import annotations

import argparse
import json
import os
import tempfile
from pathlib import Path
from typing import Any

from cli.input_files import with_format
from cli.inputs import input_options, read_with_video
from cli.terminal import say, say_json
from core.annotations.placed import place
from core.annotations.summary import summarise
from core.annotations.write import own_form, own_form_on_frames
from core.errors import BadInput


def command(parsed: argparse.Namespace) -> int:
    """Read annotations, put them on the frames of the video when one is given, and write the file."""
    options = input_options(with_format(parsed))
    annotations, table = read_with_video(parsed.annotations, parsed.video, options)
    if table is None:
        placed, value = None, own_form(annotations)
    else:
        placed = place(annotations, table, options.time_convention)
        value = own_form_on_frames(annotations, placed, table)
    write_whole(parsed.out, value)
    summary = summarise(annotations, placed)
    if parsed.json:
        say_json({"schema_version": 1, "out": str(parsed.out), **summary.to_dict()}, indent=1)
        return 0
    left_out = f", {len(placed.keys_outside)} keys outside the video left out" if placed and placed.keys_outside else ""
    say(f"{parsed.out}: {summary.n_detections} detections of {summary.format} at {len(value)} times{left_out}")
    say(*(f"  warning: {warning}" for warning in summary.warnings))
    return 0


def write_whole(path: Path, value: Any) -> None:
    """Write a JSON file that is there as a whole or not at all."""
    text = json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":")) + "\n"
    try:
        with tempfile.NamedTemporaryFile("w", encoding="utf-8", dir=path.parent, delete=False) as stream:
            stream.write(text)
        os.replace(stream.name, path)
    except OSError as error:
        raise BadInput(f"'{path}' cannot be written: {error.strerror}", code="unwritable_file", where="--out") from None
