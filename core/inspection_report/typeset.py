"""The report as PDF, set by Typst: tagged (PDF/UA-1) and, where its day is known, archivable (PDF/A-2a).

The template gets the document as a JSON file and the pictures as files beside it; nothing of them is pasted into
markup. Fonts are those that Typst brings and those of the house style, never the machine's: the same report has the
same bytes everywhere.
"""

from __future__ import annotations

import json
import shutil
import tempfile
import unicodedata
from collections.abc import Mapping
from importlib import resources
from pathlib import Path

import typst

from core.errors import BadInput, StageFailed
from core.inspection_report.pictures import files_of
from core.inspection_report.source import ReportSource
from core.json_files import JsonObject

MAIN = "report.typ"
_PICTURES = "pictures"
_SET = (
    (0x20, 0x7E),
    (0xA1, 0xAC),
    (0xAE, 0x2FF),
    (0x38E, 0x3A1),
    (0x3A3, 0x482),
    (0x48A, 0x4FF),
    (0x1E00, 0x1EFF),
    (0x2010, 0x2027),
    (0x2030, 0x2040),
    (0x20A0, 0x20C0),
    (0x2190, 0x22FF),
)
"""Characters that Typst's own fonts have. Others are written out: PDF/UA wants every character to have a glyph, and
Typst 0.15 fails on some scripts without one."""


def typeset(document: JsonObject, source: ReportSource, style: Path | None = None) -> bytes:
    """The report as PDF.

    Args:
        document: the object of report.json.
        source: where its pictures are read.
        style: folder of the house style: its files take the places of those of the same name here.

    Raises:
        BadInput: the house style is no folder, or cannot be set.
        StageFailed: the report cannot be set.
    """
    with tempfile.TemporaryDirectory(prefix="report-") as folder:
        work = Path(folder)
        for file in (resources.files(__package__) / "templates").iterdir():
            (work / file.name).write_bytes(file.read_bytes())
        if style is not None:
            _take(style, work)
        names = _copy_pictures(document, source, work)
        (work / "data.json").write_text(json.dumps(_settable(_renamed(document, names))), encoding="utf-8")
        standards = ["ua-1", "a-2a"] if document["review"]["date"] else ["ua-1"]
        return _compiled(work, standards, styled=style is not None)


def _compiled(work: Path, standards: list[str], *, styled: bool) -> bytes:
    # No folder of packages: a template that asks for one gets none from the machine's cache.
    packages = work / "packages"
    packages.mkdir()
    try:
        made = typst.compile(
            work / MAIN,
            root=work,
            font_paths=[work],
            ignore_system_fonts=True,
            pdf_standards=standards,  # type: ignore[arg-type]  # its stub wants literals
            package_path=packages,
            package_cache_path=packages,
        )
    except typst.TypstError as error:
        if styled:
            raise BadInput(f"the report cannot be set in this style: {error.message}", where="style") from None
        raise StageFailed(f"the report cannot be set: {error.message}", where="report") from None
    return bytes(made)


def _take(style: Path, work: Path) -> None:
    """Lay the files of a house style over the templates."""
    if not style.is_dir():
        raise BadInput(f"the style '{style.name}' is no folder", where="style")
    shutil.copytree(style, work, dirs_exist_ok=True)


def _copy_pictures(document: JsonObject, source: ReportSource, work: Path) -> dict[str, str]:
    """Write the pictures beside the template; gives their names there by their published paths."""
    (work / _PICTURES).mkdir()
    names = {}
    for number, path in enumerate(files_of(document["findings"])):
        data = source.picture(path)
        if data is not None:
            names[path] = f"{_PICTURES}/{number}"
            (work / names[path]).write_bytes(data)
    return names


def _renamed(document: JsonObject, names: Mapping[str, str]) -> JsonObject:
    """The document with the pictures' names in the work folder; those that are gone are null."""

    def picture(one: JsonObject | None) -> JsonObject | None:
        return {**one, "file": names[one["file"]]} if one is not None and one["file"] in names else None

    findings = [
        {**one, "pictures": {kind: picture(shown) for kind, shown in one["pictures"].items()}}
        for one in document["findings"]
    ]
    return {**document, "findings": findings}


def _settable(value: object) -> object:
    """A JSON value whose texts consist of characters that can be set."""
    if isinstance(value, str):
        return settable(value)
    if isinstance(value, Mapping):
        return {settable(str(name)): _settable(inner) for name, inner in value.items()}
    return [_settable(inner) for inner in value] if isinstance(value, list) else value


def settable(text: str) -> str:
    """The text, composed, with characters that the fonts lack written out, e.g. ``\\u4e2d``; line breaks are spaces."""
    composed = unicodedata.normalize("NFC", " ".join(text.split()))
    return "".join(char if _has_glyph(char) else _written_out(char) for char in composed)


def _has_glyph(char: str) -> bool:
    return any(low <= ord(char) <= high for low, high in _SET)


def _written_out(char: str) -> str:
    return f"\\u{ord(char):04x}" if ord(char) < 0x10000 else f"\\U{ord(char):08x}"
