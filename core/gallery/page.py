"""The gallery page: both views of the surface, the table of defects, and the frames with their boxes.

Labels and keys come from the annotation file and are not trusted: whatever enters the page passes through
`_e`, and the page's own policy forbids any script but its own.
"""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Mapping, Sequence
from html import escape

from core.gallery.assets import SCRIPT, STYLE
from core.gallery.boxes import FrameBoxes, frame_file
from core.gallery.defects import DefectLine
from core.gallery.evidence import Evidence
from core.gallery.palette import RGB
from core.scene.detection import REASONS, DetectionRow, Outcome, Reason


def _e(value: object) -> str:
    """Text for HTML content and double-quoted attributes."""
    return escape(str(value), quote=True)


def _label(text: str) -> str:
    """A label that turns no text around it, whatever direction its characters ask for."""
    return f"<bdi>{_e(text)}</bdi>"


def gallery_page(
    frames: Sequence[FrameBoxes],
    n_frames: int,
    rows: Sequence[DetectionRow],
    defects: Sequence[DefectLine],
    colors: Mapping[str, RGB],
    evidence: Sequence[Evidence] = (),
) -> str:
    """The whole page as one string.

    Args:
        frames: those with a picture beside the page.
        n_frames: frames with detections, shown or not.
        rows: all detections.
        defects: rows of the table, in its order; a best frame has a picture beside the page.
        colors: by label, as drawn in the pictures.
        evidence: of the defects, each with a picture beside the page.
    """
    mapped = sum(row.outcome == Outcome.MAPPED for row in rows)
    lead = f"{len(rows)} detections on {n_frames} frames, {mapped} on the surface, {len(defects)} defects"
    return "\n".join(
        [
            "<!doctype html>",
            '<html lang="en">',
            _head(),
            "<body>",
            f'<header><h1>Inspection gallery</h1><p class="lead">{_e(lead)}</p></header>',
            "<main>",
            _views(),
            _defects(defects),
            _evidence(evidence),
            _gallery(frames, n_frames, rows, colors),
            "</main>",
            f"<footer><p>{_e(_without_frame(rows))}</p></footer>",
            '<dialog aria-label="Frame"><img alt=""><p></p></dialog>',
            f"<script>{SCRIPT}</script>",
            "</body>",
            "</html>",
            "",
        ]
    )


def _head() -> str:
    digest = base64.b64encode(hashlib.sha256(SCRIPT.encode()).digest()).decode()
    policy = f"default-src 'none'; img-src 'self' file:; style-src 'unsafe-inline'; script-src 'sha256-{digest}'"
    return (
        '<head><meta charset="utf-8">'
        f'<meta http-equiv="Content-Security-Policy" content="{_e(policy)}">'
        '<meta name="viewport" content="width=device-width, initial-scale=1">'
        f"<title>Inspection gallery</title><style>{STYLE}</style></head>"
    )


def _views() -> str:
    alt = "The reconstructed surface from side {n}; defects are red and numbered as in the table"
    pictures = "".join(
        f'<a href="mesh_{n}.png"><img src="mesh_{n}.png" alt="{_e(alt.format(n=n))}" width="1600" height="1200"></a>'
        for n in (1, 2)
    )
    return f'<section aria-labelledby="s"><h2 id="s">Surface</h2><div class="views">{pictures}</div></section>'


def _defects(lines: Sequence[DefectLine]) -> str:
    if not lines:
        body = "<p>No defect was placed on the surface.</p>"
    else:
        columns = "<th>Visits</th><th>Detections</th><th>Seen in</th><th>Position (model units)</th>"
        head = f'<tr><th class="t">Defect</th><th class="t">Label</th><th>Size</th><th>From</th><th>To</th>{columns}'
        head += '<th class="t">Best frame</th></tr>'
        table = "".join(_defect_row(line) for line in lines)
        body = f'<div class="scroll"><table><thead>{head}</thead><tbody>{table}</tbody></table></div>'
        body = f"<p>Largest first.</p>{body}"
    return f'<section aria-labelledby="e"><h2 id="e">Defects on the surface</h2>{body}</section>'


def _defect_row(line: DefectLine) -> str:
    number, best = line.number, line.best
    link = f'<a href="{_e(frame_file(best.source_index))}">{best.time_s:.2f} s</a>' if best else ""
    return (
        f'<tr><td class="t"><button type="button" data-defect="{number}" aria-pressed="false">D{number}</button></td>'
        f'<td class="t">{_label(line.label)}</td><td>{_e(line.size_text)}</td>'
        f"<td>{_seconds(line.start_s)}</td><td>{_seconds(line.end_s)}</td>"
        f"<td>{line.visits}</td><td>{line.n_detections}</td><td>{line.n_frames} of {line.n_could_show} frames</td>"
        f'<td>{_e(", ".join(f"{value:.3f}" for value in line.place))}</td><td class="t">{link}</td></tr>'
    )


def _seconds(value: float | None) -> str:
    return "" if value is None else f"{value:.2f} s"


def _evidence(evidence: Sequence[Evidence]) -> str:
    """A picture of every defect; nothing by rules that make none."""
    if not evidence:
        return ""
    figures = "".join(
        f'<figure><a href="{_e(one.file_name)}">'
        f'<img src="{_e(one.file_name)}" alt="{_e(one.caption)}" loading="lazy"></a>'
        f"<figcaption>{_e(one.caption)}</figcaption></figure>"
        for one in evidence
    )
    return f'<section aria-labelledby="v"><h2 id="v">Evidence</h2><div class="views">{figures}</div></section>'


def _gallery(
    frames: Sequence[FrameBoxes], n_frames: int, rows: Sequence[DetectionRow], colors: Mapping[str, RGB]
) -> str:
    note = ""
    if len(frames) < n_frames:
        note = (
            f"<p>{len(frames)} of {n_frames} frames are shown: the best-scored frame of every defect and of every "
            "label, then the others by their best score.</p>"
        )
    elif not frames:
        note = "<p>The annotations hold no detection inside the video.</p>"
    figures = "".join(_figure(frame, colors) for frame in frames)
    return (
        '<section aria-labelledby="f"><h2 id="f">Frames</h2>'
        f'{note}{_filters(rows)}<div class="grid">{figures}</div></section>'
    )


def _filters(rows: Sequence[DetectionRow]) -> str:
    defects = sorted({row.defect_id for row in rows if row.defect_id is not None})
    present = [outcome for outcome in Outcome if any(row.outcome == outcome for row in rows)]
    fields = (
        ("label", "Label", [(label, label) for label in sorted({row.label for row in rows})]),
        ("outcome", "Outcome", [(outcome, outcome) for outcome in present]),
        ("defect", "Defect", [(str(number), f"D{number}") for number in defects]),
    )
    selects = "".join(
        f'<label>{name}<select id="{key}"><option value="">all</option>'
        + "".join(f'<option value="{_e(value)}">{_e(text)}</option>' for value, text in options)
        + "</select></label>"
        for key, name, options in fields
    )
    reset = '<button type="button" id="reset">Show all</button>'
    return f'<form class="filters">{selects}{reset}<output id="shown" aria-live="polite"></output></form>'


def _figure(frame: FrameBoxes, colors: Mapping[str, RGB]) -> str:
    labels = ", ".join(sorted({row.label for row in frame.rows}))
    alt = f"Frame {frame.source_index} at {frame.time_s:.2f} s: {labels}"
    items = "".join(_item(row, colors[row.label]) for row in frame.rows)
    name = _e(frame.file_name)
    return (
        f'<figure data-frame="{frame.source_index}"><a class="picture" href="{name}">'
        f'<img src="{name}" alt="{_e(alt)}" loading="lazy"></a>'
        f"<figcaption><strong>{frame.time_s:.2f} s</strong> frame {frame.source_index}<ul>{items}</ul></figcaption>"
        "</figure>"
    )


def _item(row: DetectionRow, color: RGB) -> str:
    defect = "" if row.defect_id is None else str(row.defect_id)
    score = f" {row.score:.2f}" if row.score is not None else ""
    state = f"D{defect}" if defect else (row.reason or row.outcome).replace("_", " ")
    hint = f"{row.support_points} support points" if row.reason is None else REASONS[row.reason]
    swatch = f'<span class="dot" style="background:rgb({color[0]},{color[1]},{color[2]})"></span>'
    return (
        f'<li data-label="{_e(row.label)}" data-outcome="{_e(row.outcome)}" data-defect="{_e(defect)}">{swatch}'
        f"<span>{_label(row.label)}{score}</span>"
        f'<span class="state {_e(row.outcome)}" title="{_e(hint)}">{_e(state)}</span></li>'
    )


def _without_frame(rows: Sequence[DetectionRow]) -> str:
    outside = sum(row.reason == Reason.NO_FRAME for row in rows)
    legend = "Solid boxes are on the surface, dashed boxes are not."
    return f"{legend} {outside} detections lie outside the video and have no frame." if outside else legend
