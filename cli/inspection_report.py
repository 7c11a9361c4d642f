"""`bladeatlas report`: the report of a finished result, for people, as PDF, HTML, CSV and JSON."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from cli.input_files import limits_text
from cli.terminal import say, say_json
from core.errors import BadInput
from core.inspection_report.document import Shown, is_day, report_document
from core.inspection_report.forms import Form, written
from core.inspection_report.source import files_below, read_source
from core.outputs import DEFECTS
from core.review.published import reviewed_result
from core.settings.limits import parse_limits


def command(parsed: argparse.Namespace) -> int:
    """Write the forms that are asked for, and say where they lie."""
    result: Path = parsed.result
    if parsed.date is not None and not is_day(parsed.date):
        raise BadInput(f"'{parsed.date}' is no day of the form YYYY-MM-DD", where="--date")
    source = read_source(files_below(result))
    reviewed = reviewed_result(result).reviewed if (result / DEFECTS).is_file() else None
    limits = None if parsed.limits is None else parse_limits(limits_text(parsed.limits))
    shown = Shown(limits=limits, inches=parsed.units == "in")
    document = report_document(source, reviewed, parsed.reviewer, parsed.date, shown=shown)
    paths = []
    for form in chosen(parsed.form):
        data = written(form, document, source, parsed.style)
        paths.append(_write(parsed.out, form, data))
    if parsed.json:
        say_json({"files": [str(path) for path in paths]})
    else:
        say(*(str(path) for path in paths))
    return 0


def chosen(names: Sequence[str]) -> list[Form]:
    """The forms of these names, all without any.

    Raises:
        BadInput: there is no such form.
    """
    unknown = [name for name in names if name not in tuple(Form)]
    if unknown:
        raise BadInput(f"'{unknown[0]}' is no form of the report; there are {', '.join(Form)}", where="--form")
    return [form for form in Form if not names or form in names]


def _write(folder: Path, form: Form, data: bytes) -> Path:
    path = folder / f"report.{form}"
    try:
        folder.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data)
    except OSError as error:
        raise BadInput(f"'{path}' cannot be written: {error.strerror}", where="--out") from None
    return path
