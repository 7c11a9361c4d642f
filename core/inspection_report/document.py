"""The report as one object (`report.json`): every other form of it shows this and nothing else.

Texts come from the annotation file, the caller and the reviewer; they are data, and each form shows them as text.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from datetime import date

from core.inspection_report.finding import (
    UNKNOWN,
    added_objects,
    blade_text,
    finding_objects,
    is_relative,
    unattached_texts,
    verdict_text,
)
from core.inspection_report.source import ReportSource
from core.json_files import JsonObject
from core.report.limits import limit_text, limits_document, limits_of
from core.review.state import Review, Reviewed
from core.scene.defect import MODEL_UNIT, DefectRecord
from core.scene.on_row import blade_name
from core.scene.size import MM_PER_INCH
from core.settings.limits import Limit

SCHEMA_VERSION = 1
_DAY = len("YYYY-MM-DD")
NO_ROW = "the row of blades was not looked for"


@dataclass(frozen=True)
class Shown:
    """How a report shows what is published."""

    limits: Sequence[Limit] | None = None
    """Of the shop; None = those that the result was compared with, if any."""
    inches: bool = False
    """Lengths in texts in inches instead of millimetres; numbers stay in the unit that stands beside them."""


AS_PUBLISHED = Shown()
"""In millimetres, with the result's own limits."""


def report_document(
    source: ReportSource,
    reviewed: Reviewed | None = None,
    reviewer: str | None = None,
    day: str | None = None,
    ended: str | None = None,
    shown: Shown = AS_PUBLISHED,
) -> JsonObject:
    """The object of report.json.

    Args:
        source: of the result.
        reviewed: what people say of it; None = nothing yet.
        reviewer: who signs; by default whoever the review names, if that is one person.
        day: of the report, ``YYYY-MM-DD``; by default that of the last word of the review.
        ended: day on which the inspection ended: that of the report where nothing else tells one.
        shown: unit of the lengths in texts, and limits of the shop.
    """
    summary, quality = source.summary, source.quality
    reviews = {} if reviewed is None else {one.name: one.review for one in reviewed.findings}
    compared = _compared(source, shown)
    findings = finding_objects(source, reviews, compared, inches=shown.inches)
    coverage = [_coverage(model, source, findings) for model in source.models]
    return {
        "schema_version": SCHEMA_VERSION,
        "title": str(summary.get("label") or summary.get("external_id") or "Inspection"),
        "identity": _identity(summary),
        "videos": _videos(summary),
        "state": summary.get("state"),
        "message": summary.get("message"),
        "verdict": quality.get("verdict"),
        "flags": [_flag(flag) for flag in quality.get("flags") or ()],
        "notes": list(quality.get("notes") or ()),
        "scale": _scale(summary, shown.inches),
        "limits": None if compared is None else _limits(compared, source, shown.inches),
        "counts": _counts(findings, source),
        "findings": findings,
        "coverage": coverage,
        "not_seen": _not_seen(coverage, quality),
        "method": _method(summary),
        "added": [] if reviewed is None else added_objects(reviewed, inches=shown.inches),
        "review": {
            "reviewer": reviewer or _only_reviewer(reviews.values()),
            "date": day or _last_day(reviews.values()) or ended,
            "decided": sum(one["human"]["decided"] for one in findings),
            "unattached": [] if reviewed is None else unattached_texts(reviewed),
        },
    }


def _only_reviewer(reviews: Iterable[Review]) -> str | None:
    names = {one.by for one in reviews if one.by}
    return names.pop() if len(names) == 1 else None


def _last_day(reviews: Iterable[Review]) -> str | None:
    """Day of the last word, by the clock of whoever kept it; None without any or where a time is none."""
    days = [one.time[:_DAY] for one in reviews if one.time]
    return max((day for day in days if is_day(day)), default=None)


def is_day(text: str) -> bool:
    """Whether a text is a day, ``YYYY-MM-DD``."""
    try:
        return date.fromisoformat(text).isoformat() == text
    except ValueError:
        return False


def _identity(summary: JsonObject) -> list[list[str]]:
    """Names and texts by which the part and the inspection are known."""
    rows: list[list[object]] = [["Label", summary.get("label")], ["External id", summary.get("external_id")]]
    rows += [[str(name), value] for name, value in (summary.get("metadata") or {}).items()]
    return [[str(name), str(value)] for name, value in rows if value not in (None, "")]


def _videos(summary: JsonObject) -> list[JsonObject]:
    """Each video with its hash and length, and the hash of its annotations."""
    frame, inputs = summary.get("frame") or {}, summary.get("inputs") or {}
    lengths = frame.get("videos") or [frame]
    return [
        {
            "name": f"video {number}" if len(lengths) > 1 else "video",
            "sha256": inputs.get(_role("video", number)),
            "annotations_sha256": inputs.get(_role("annotations", number)),
            "frames": one.get("n_frames"),
            "duration_s": one.get("duration_s"),
            "width": frame.get("width"),
            "height": frame.get("height"),
        }
        for number, one in enumerate(lengths)
    ]


def _role(what: str, number: int) -> str:
    return f"{what}_{number}" if number else what


def _flag(flag: JsonObject) -> JsonObject:
    return {
        "code": flag["code"],
        "severity": flag["severity"],
        "text": flag.get("meaning") or flag["code"],
        "where": flag.get("where") or "",
        "value": flag.get("value"),
        "threshold": flag.get("threshold"),
    }


def _compared(source: ReportSource, shown: Shown) -> JsonObject | None:
    """The object of limits.json, for the limits that are told or else the result's own; None without any."""
    limits = shown.limits
    if limits is None and source.limits is not None:
        limits = limits_of(source.limits)
    if limits is None:
        return None
    records = [DefectRecord.from_dict(record) for record in source.defects]
    return limits_document(limits, records, inches=shown.inches)


def _limits(compared: JsonObject, source: ReportSource, inches: bool) -> JsonObject:
    """The table of the shop in words, and what it says of the numbers of findings."""
    return {
        "rows": [{"line": limit["line"], "text": limit_text(limit, inches=inches)} for limit in compared["limits"]],
        "counts": [
            {
                "text": blade_text(one["blade"], relative=is_relative(one["blade"], source)),
                "verdict": verdict_text(one["verdict"]),
                "reason": one["reason"],
            }
            for one in compared["counts"]
        ],
        "note": f"Compared at {compared['sigmas']:g} standard deviations. What it means for the part a person says.",
    }


def _scale(summary: JsonObject, inches: bool) -> JsonObject:
    scale = summary.get("scale") or {}
    unit = scale.get("unit") or MODEL_UNIT
    if unit == MODEL_UNIT:
        text = "No scale is known: sizes are unscaled, and may be compared with each other but not read as millimetres."
    else:
        sigma = scale.get("sigma")
        factor, name = (1.0 / MM_PER_INCH, "in") if inches else (1.0, unit)
        spread = "" if sigma is None else f" ± {factor * sigma:.2g}"
        text = (
            f"Scale: {factor * scale['value']:.4g}{spread} {name} in a unit of the model, from {scale.get('source')}."
        )
    return {"unit": unit, "text": text}


def _counts(findings: Sequence[JsonObject], source: ReportSource) -> JsonObject:
    """Findings by label and by blade, as a table."""
    labels = sorted({one["label"] for one in findings})
    blades = sorted({_blade(one) for one in findings}, key=_blade_order)
    pairs = Counter((_blade(one), one["label"]) for one in findings)
    least = source.summary.get("headline", {}).get("defects_at_least")
    total = len(findings)
    return {
        "findings": total,
        "at_least": total if least is None else least,
        "detections": len(source.detections),
        "labels": labels,
        "rows": [
            {
                "blade": blade,
                "by_label": [pairs[blade, label] for label in labels],
                "findings": sum(pairs[blade, label] for label in labels),
            }
            for blade in blades
        ],
    }


def _blade(finding: JsonObject) -> str:
    place = finding["place"]
    return blade_text(place["blade"], relative=place["relative"])


def _blade_order(blade: str) -> tuple[bool, int, str]:
    """By number; those that are not known, or whose model has its own count, come last."""
    number = blade.removeprefix("blade ").split(" ")[0]
    return not number.isdecimal(), int(number) if number.isdecimal() else 0, blade


def _coverage(model: int, source: ReportSource, findings: Sequence[JsonObject]) -> JsonObject:
    """What was seen of each blade of a model."""
    row: JsonObject = source.rows.get(model) or {}
    own = [one for one in findings if one["model"] == model]
    status = row.get("status") or UNKNOWN
    known = status != UNKNOWN
    reason = None if known else row.get("reason_text") or NO_ROW
    blades = [_blade_seen(one, model, own, source) for one in row.get("coverage") or ()] if known else []
    return {"model": model, "status": status, "reason": reason, "count": row.get("count"), "blades": blades}


def _blade_seen(
    one: Mapping[str, object], model: int, findings: Sequence[JsonObject], source: ReportSource
) -> JsonObject:
    name = blade_name(str(one["blade"]), model, (source.rows.get(model) or {}).get("on_first"))
    return {
        "blade": name,
        "text": blade_text(name, relative=is_relative(name, source)),
        "findings": sum(str(finding["place"]["blade"]) == name for finding in findings),
        "share": one.get("share"),
        "views_2": one.get("views_2"),
        "views_3": one.get("views_3"),
    }


def _not_seen(coverage: Sequence[JsonObject], quality: JsonObject) -> list[str]:
    """What this inspection cannot say anything about, in sentences."""
    said = [
        "A place without a finding was either seen and nothing was detected, or not seen: this list tells the second."
    ]
    for one in coverage:
        which = f"Model {one['model']}: " if len(coverage) > 1 else ""
        if one["status"] == UNKNOWN:
            said.append(
                f"{which}The row of blades is unknown ({one['reason']}), so what was not seen of each blade cannot be "
                "told."
            )
        if one["blades"]:
            unseen = [f"{100 * (1 - blade['views_2']):.0f} % of {blade['text']}" for blade in one["blades"]]
            said.append(
                f"{which}Of the reconstructed surface no two views see at a usable angle: {', '.join(unseen)}. What no "
                "view saw has no surface, and is not even counted in these shares."
            )
        if one["count"] and one["blades"]:
            low, high = one["count"]
            row = str(low) if low == high else f"{low} to {high}"
            said.append(f"{which}{len(one['blades'])} of {row} blades of the row appear; the others were not seen.")
    registration = quality.get("registration") or {}
    frames, registered = registration.get("frames"), registration.get("registered")
    if frames is not None and registered is not None and registered < frames:
        said.append(
            f"{frames - registered} of {frames} frames used have no place in the model; what only they show is not on "
            "the surface."
        )
    for lost in quality.get("lost") or ():
        said.append(f"{lost['detections']} detections have no place: {lost['meaning']}.")
    return said


def _method(summary: JsonObject) -> JsonObject:
    parameters = summary.get("parameters") or {}
    return {
        "fingerprint": summary.get("fingerprint"),
        "preset": summary.get("preset"),
        "versions": {str(name): str(value) for name, value in (summary.get("versions") or {}).items()},
        "changed": [str(name) for name in parameters.get("overrides") or ()],
        "parameters": [
            [name, _value(value)] for name, value in _flat(parameters, "") if not name.startswith("overrides")
        ],
    }


def _flat(value: object, name: str) -> list[tuple[str, object]]:
    """Single values of nested objects by dotted name."""
    if not isinstance(value, Mapping):
        return [(name, value)]
    return [pair for key, inner in value.items() for pair in _flat(inner, f"{name}.{key}" if name else str(key))]


def _value(value: object) -> str:
    if value is None:
        return "none"
    if isinstance(value, list | tuple):
        return ", ".join(_value(one) for one in value) or "none"
    return f"{value:g}" if isinstance(value, float) else str(value)
