"""`bladeatlas row`: the row of blades of a finished result, computed from its files and written into them."""

from __future__ import annotations

import argparse
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cli.input_files import limits_text
from cli.terminal import say, say_json
from core.errors import BadInput
from core.json_files import read_json
from core.outputs import ROW, model_folder, model_numbers
from core.scene.size import Scale
from core.settings import make_settings
from core.settings.limits import parse_limits
from core.settings.row import RowSettings

NOT_SEEN = 0.5
"""A blade less than this share of whose surface two views see at a usable angle was not seen well."""


def command(parsed: argparse.Namespace) -> int:
    """Write row.json and the column `blade` of a result, and say what was found."""
    # Loaded here: the row needs the ray caster, `--help` does not.
    from core.row.published import write_row

    folder: Path = parsed.result
    limits = None if parsed.limits is None else parse_limits(limits_text(parsed.limits))
    write_row(folder, told_row(parsed.set), limits)
    document = read_json(folder / ROW)
    if parsed.json:
        say_json(document, indent=1)
    else:
        further = {number: read_json(model_folder(folder, number) / ROW) for number in model_numbers(folder)[1:]}
        say(*row_lines(document), *(further_line(number, one) for number, one in further.items()))
    return 0


def told_row(pairs: Sequence[str]) -> RowSettings:
    """What the user tells of the row by `--set NAME=VALUE`: the options `row.NAME` of a run.

    Raises:
        BadInput: no such option, or a value that does not fit.
    """
    options = {}
    for pair in pairs:
        name, given, value = pair.partition("=")
        if not given:
            raise BadInput(f"'{pair}' is no NAME=VALUE", where="--set")
        options[f"row.{name}"] = value
    return make_settings(options=options).row


def row_lines(document: dict[str, Any]) -> list[str]:
    """What the object of ``row.json`` says, in two or three lines; in one where the row is unknown."""
    if document["status"] == "unknown":
        return [f"row: unknown: {document['reason_text']}"]
    low, high = document["count"]
    blades = str(low) if low == high else f"{low} to {high}"
    pitch = f"{document['pitch_deg']:.3f} +- {document['pitch_sigma_deg']:.3f} degrees"
    scale = Scale.from_dict(document.get("scale") or {})
    known = [] if scale is None else [f"scale: {scale.value:.4g} +- {scale.sigma:.2g} mm, from {scale.source}"]
    return [f"row: pitch {pitch}, {blades} blades", *known, closing_line(document)]


def further_line(number: int, document: dict[str, Any]) -> str:
    """How the blades of a further model lie on the row of the first, in one line."""
    told = document["on_first"]
    if not told["names"]:
        return f"model {number}: {told['reason_text'] or 'its blades lie before number 1 of the first model'}"
    names = ", ".join(f"{own} is {first}" for own, first in told["names"].items())
    how = str(told["offset_from"]).replace("_", " ")
    return f"model {number}: on the row of the first model, by {how}; of its blades {names}"


def closing_line(document: dict[str, object]) -> str:
    """Blades seen, findings on each, and what was not seen, in one line."""
    coverage, findings = document["coverage"], document["findings"]
    assert isinstance(coverage, list)  # both as `core.row.published` writes them
    assert isinstance(findings, list)
    on = Counter(one["blade"] for one in findings)
    numbers = [int(one["blade"]) for one in coverage]
    each = ", ".join(f"blade {number}: {on[number]}" for number in numbers)
    weak = [f"{one['blade']} ({100 * one['views_2']:.0f} %)" for one in coverage if one["views_2"] < NOT_SEEN]
    text = f"{len(numbers)} blades seen; findings on {each}"
    text += f"; on no blade: {on[None]}" if on[None] else ""
    mean = float(np.mean([one["views_2"] for one in coverage]))
    text += f"; two views see {100 * mean:.0f} % of their reconstructed surface"
    return text + (f", less than half of blade {', '.join(weak)}" if weak else "")
