"""`bladeatlas options`: every setting in words."""

from __future__ import annotations

import argparse
import json

from rich.table import Table

from cli.terminal import console, say, say_json
from core.errors import BadInput
from core.settings import PRESET_NAMES
from core.settings.describe import OptionInfo, describe_options


def command(parsed: argparse.Namespace) -> int:
    """Print all options with their values in the chosen preset."""
    if parsed.preset not in PRESET_NAMES:
        raise BadInput(f"unknown preset '{parsed.preset}'; known: {', '.join(PRESET_NAMES)}", where="--preset")
    described = describe_options()
    if parsed.json:
        rows = [{**option.to_dict(), "value": option.value(parsed.preset)} for option in described]
        say_json({"schema_version": 1, "preset": parsed.preset, "options": rows}, indent=1)
        return 0
    drawn = console(error=False)
    if drawn.is_terminal:
        drawn.print(_table(described, parsed.preset))
    else:
        say(*(plain_line(option, parsed.preset) for option in described))
    return 0


def plain_line(option: OptionInfo, preset: str) -> str:
    """One option in one line, for pipes: ``name = value unit  range  meaning  [source]  other presets``."""
    value = " ".join(filter(None, [json.dumps(option.value(preset)), option.unit]))
    return f"{option.name} = {value}  ({option.range})  {option.meaning}  [{option.source}]{_others(option, preset)}"


def _others(option: OptionInfo, preset: str) -> str:
    texts = [
        f"{name}: {json.dumps(option.value(name))}"
        for name in PRESET_NAMES
        if name != preset and option.value(name) != option.value(preset)
    ]
    return "  " + ", ".join(texts) if texts else ""


def _table(described: list[OptionInfo], preset: str) -> Table:
    table = Table(title=f"options, preset {preset}", title_justify="left", box=None, pad_edge=False)
    for title in ("option", "value", "unit", "range", "meaning", "source", "other presets"):
        table.add_column(title, overflow="fold", no_wrap=title == "option")
    for option in described:
        table.add_row(
            option.name,
            json.dumps(option.value(preset)),
            option.unit,
            option.range,
            option.meaning,
            option.source,
            _others(option, preset).strip(),
        )
    return table
