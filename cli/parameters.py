"""From command-line arguments and a parameter file to settings."""

from __future__ import annotations

import argparse
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cli.input_files import calibration_options, limit_options, with_format
from core.errors import BadInput
from core.metadata import parse_metadata
from core.settings import Settings, make_settings

_KEYS = ("preset", "options", "label", "external_id", "priority", "metadata")
_HIGHEST_PRIORITY = 9
_MAX_PARAMETER_BYTES = 1 << 20


@dataclass(frozen=True)
class Parameters:
    """What a run was asked for: a preset, options over it, and what a server also wants to know."""

    preset: str = "default"
    options: dict[str, Any] = field(default_factory=dict)
    label: str = ""
    external_id: str = ""
    priority: int = 0
    """0 to 9; only a server has others to put it before."""
    metadata: dict[str, str] = field(default_factory=dict)
    """What is known of the engine and the work; see `core.metadata`."""

    def settings(self) -> Settings:
        """The run's settings; `BadInput` names what does not fit."""
        return make_settings(self.preset, self.options)


def from_arguments(parsed: argparse.Namespace) -> Parameters:
    """Parameter file first, then what the command line says over it."""
    base = read_parameters(parsed.parameters) if parsed.parameters else Parameters()
    options = dict(base.options)
    if parsed.roi is not None:
        options.update(parse_roi(parsed.roi))
    if parsed.allow_truncated:
        options["input.allow_truncated"] = True
    if parsed.fps is not None:
        options["input.fps"] = parsed.fps
    if parsed.seed is not None:
        options["seed"] = parsed.seed
    options.update(calibration_options(parsed.calibration))
    options.update(limit_options(parsed.limits))
    options.update(parse_assignment(text) for text in with_format(parsed))
    return Parameters(parsed.preset or base.preset, options, base.label, base.external_id, base.priority, base.metadata)


def read_parameters(path: Path) -> Parameters:
    """Read ``{preset, options {dotted: value}, label, external_id, priority, metadata}``; others are refused."""
    where = str(path)
    try:
        if path.stat().st_size > _MAX_PARAMETER_BYTES:
            raise BadInput("the parameter file is larger than 1 MiB", where=where)
        # Editors on Windows begin a file with a byte order mark.
        data = json.loads(path.read_text(encoding="utf-8-sig"), parse_constant=_refuse_constant)
    except OSError as error:
        raise BadInput(f"cannot read the parameter file: {error.strerror}", where=where) from None
    except (ValueError, RecursionError) as error:
        raise BadInput(f"the parameter file is not valid JSON: {error}", where=where) from None
    if not isinstance(data, dict):
        raise BadInput("the parameter file must hold a JSON object", where=where)
    for key in data:
        if key not in _KEYS:
            raise BadInput(f"unknown key '{key}' in the parameter file; known: {', '.join(_KEYS)}", where=where)
    options = data.get("options", {})
    if not isinstance(options, dict):
        raise BadInput("'options' must be an object of dotted names and values", where=where)
    texts = {key: data[key] for key in ("preset", "label", "external_id") if data.get(key) is not None}
    for key, value in texts.items():
        if not isinstance(value, str):
            raise BadInput(f"'{key}' must be a text", where=where)
    priority = parse_priority(data.get("priority", 0), where)
    metadata = parse_metadata(data.get("metadata", {}), where)
    return Parameters(options=options, priority=priority, metadata=metadata, **texts)


def parse_priority(value: Any, where: str) -> int:
    """A whole number from 0 to 9; `BadInput` for anything else."""
    if type(value) is not int or not 0 <= value <= _HIGHEST_PRIORITY:
        raise BadInput(f"'priority' must be a whole number from 0 to {_HIGHEST_PRIORITY}", where=where)
    return value


def parse_assignment(text: str) -> tuple[str, Any]:
    """``name=value`` with a JSON value, or else a plain text: ``0.5``, ``true``, ``null``, ``[40, 55]``, ``disk``."""
    name, sign, value = text.partition("=")
    if not sign or not name.strip():
        raise BadInput(f"'{text}' is not NAME=VALUE", where="--set")
    try:
        return name.strip(), json.loads(value, parse_constant=_refuse_constant)
    except ValueError:
        return name.strip(), value.strip()


def parse_roi(text: str) -> dict[str, float]:
    """``full`` or ``x0,y0,x1,y1`` in shares of the source frame, as options."""
    parts = ["0", "0", "1", "1"] if text.strip() == "full" else text.split(",")
    try:
        x0, y0, x1, y1 = (float(part) for part in parts)
    except ValueError:
        raise BadInput(f"'{text}' is neither 'full' nor x0,y0,x1,y1", where="--roi") from None
    if not (0 <= x0 < x1 <= 1 and 0 <= y0 < y1 <= 1):
        raise BadInput(f"'{text}' is empty or outside the frame: 0 <= x0 < x1 <= 1, 0 <= y0 < y1 <= 1", where="--roi")
    return {"roi.x0": x0, "roi.y0": y0, "roi.x1": x1, "roi.y1": y1}


def _refuse_constant(text: str) -> float:
    raise ValueError(f"{text} is not a finite number")
