"""The files of a page, written into the folder where its surface and pictures lie: the page itself and its data."""

from __future__ import annotations

import base64
import json
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path

from core.json_files import JsonObject
from core.outputs import DOCUMENT
from core.viewer.document import ViewerSource, viewer_document

DATA = "data.js"
_BUNDLE = "bundle"
_STUDY = "study"


def bundle() -> dict[str, bytes]:
    """The built page: bytes by file name, sorted."""
    return _files(resources.files("core.viewer") / _BUNDLE)


def study_bundle() -> dict[str, bytes]:
    """The built page of the study that asks people: bytes by file name, sorted."""
    return _files(resources.files("core.viewer") / _BUNDLE / _STUDY)


def _files(folder: Traversable) -> dict[str, bytes]:
    files = sorted(folder.iterdir(), key=lambda file: file.name)
    return {file.name: file.read_bytes() for file in files if file.is_file()}


def ascii_json(document: JsonObject) -> str:
    """JSON on one line that any encoding reads alike."""
    return json.dumps(document, ensure_ascii=True, allow_nan=False, separators=(",", ":"))


def in_script(text: str) -> str:
    """JSON whose texts, which strangers wrote, cannot end a script that it may be pasted into."""
    return text.replace("<", "\\u003c")


def write_page(folder: Path, source: ViewerSource, surface: Path | None) -> list[str]:
    """Write the page, its document and the same as a script; gives the names of the files.

    Browsers let a page that was opened as a file read no other file, but they run a script beside it: so the document
    and the surface are in `data.js` too.

    Args:
        folder: made when it is not there.
        source: what it shows.
        surface: the GLB of its surface; None without one.
    """
    folder.mkdir(parents=True, exist_ok=True)
    document = viewer_document(source)
    text = ascii_json(document)
    (folder / DOCUMENT).write_text(text + "\n", encoding="ascii", newline="\n")
    shown = surface if document["surface"] is not None else None
    encoded = None if shown is None else base64.b64encode(shown.read_bytes()).decode("ascii")
    viewer = in_script(text)
    mesh = "null" if encoded is None else f'"{encoded}"'
    script = f"window.BLADEATLAS = {{viewer: {viewer}, surface: {mesh}}};\n"
    (folder / DATA).write_text(script, encoding="ascii", newline="\n")
    files = bundle()
    for name, content in files.items():
        (folder / name).write_bytes(content)
    return [*files, DOCUMENT, DATA]
