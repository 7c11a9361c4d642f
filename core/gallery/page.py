"""The gallery page: both views of the surface, the table of defects, and the frames with their boxes.

Labels and keys come from the annotation file and are not trusted: the template escapes whatever enters the page, and
the page's own policy forbids any script but its own. Style and script are inline: the page needs no network.
"""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Mapping, Sequence
from importlib import resources

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from core.gallery.boxes import FrameBoxes, frame_file
from core.gallery.defects import DefectLine
from core.gallery.evidence import Evidence
from core.gallery.palette import RGB
from core.scene.defect import least_defects
from core.scene.detection import REASONS, DetectionRow, Outcome, Reason

_PACKAGE = "core.gallery"
_PAGES = Environment(
    loader=PackageLoader(_PACKAGE), autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
)


def gallery_page(
    frames: Sequence[FrameBoxes],
    n_frames: int,
    rows: Sequence[DetectionRow],
    defects: Sequence[DefectLine],
    colors: Mapping[str, RGB],
    evidence: Sequence[Evidence] = (),
    n_videos: int = 1,
    row_map: str = "",
) -> str:
    """The whole page as one string.

    Args:
        frames: those with a picture beside the page.
        n_frames: frames with detections, shown or not.
        rows: all detections.
        defects: rows of the table, in its order; a best frame has a picture beside the page.
        colors: by label, as drawn in the pictures.
        evidence: of the defects, each with a picture beside the page; empty by rules that make none.
        n_videos: videos of the run; where there are several, frames and times name theirs.
        row_map: map of the row of blades as SVG, every text of it escaped; empty where there is none.
    """
    mapped = sum(row.outcome == Outcome.MAPPED for row in rows)
    script = _asset("gallery.js").strip()
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return _PAGES.get_template("gallery.html").render(
        policy=f"default-src 'none'; img-src 'self' file:; style-src 'unsafe-inline'; script-src 'sha256-{digest}'",
        # Both are files of this package, and nothing from outside enters them.
        style=Markup(_asset("gallery.css")),
        script=Markup(script),
        lead=f"{len(rows)} detections on {n_frames} frames, {mapped} on the surface, {_count(defects)} defects",
        n_models=len({line.model for line in defects}),
        defects=defects,
        evidence=evidence,
        frames=frames,
        n_frames=n_frames,
        n_outside=sum(row.reason == Reason.NO_FRAME for row in rows),
        filters=_filters(rows),
        colors=colors,
        reasons=REASONS,
        frame_file=frame_file,
        row_map=Markup(row_map),  # drawn by this program
        n_videos=n_videos,
    )


def _count(defects: Sequence[DefectLine]) -> str:
    """How many defects there are: a range where several models may each hold a record of the same one."""
    least = least_defects(line.model for line in defects)
    return str(len(defects)) if least == len(defects) else f"{least} to {len(defects)}"


def _asset(name: str) -> str:
    return (resources.files(_PACKAGE) / "templates" / name).read_text(encoding="utf-8")


def _filters(rows: Sequence[DetectionRow]) -> list[tuple[str, str, list[tuple[str, str]]]]:
    """Each choice as its id, its name, and its options as values with their texts."""
    defects = sorted({row.defect_id for row in rows if row.defect_id is not None})
    present = [outcome for outcome in Outcome if any(row.outcome == outcome for row in rows)]
    return [
        ("label", "Label", [(label, label) for label in sorted({row.label for row in rows})]),
        ("outcome", "Outcome", [(outcome, outcome) for outcome in present]),
        ("defect", "Defect", [(str(number), f"D{number}") for number in defects]),
    ]
