"""One finding as the report tells it: what is known in numbers, and the same in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from core.inspection_report.pictures import finding_pictures
from core.inspection_report.source import ReportSource
from core.json_files import JsonObject
from core.review.state import Review, Reviewed, ReviewedFinding
from core.review.target import Target
from core.review.words import ReviewState, TargetKind
from core.scene.defect import MODEL_UNIT
from core.scene.size import MM_PER_INCH, LengthUnit

UNKNOWN = "unknown"
UNSCALED = "unscaled"
NOT_REVIEWED = "not reviewed"
_NO_PART = ("", UNKNOWN, None)


def finding_objects(
    source: ReportSource, reviews: Mapping[str, Review], compared: JsonObject | None = None, *, inches: bool = False
) -> list[JsonObject]:
    """All findings of a result, the largest first, unknown sizes last, equal ones by number.

    Args:
        source: of the result.
        reviews: what people say, by the name of the finding; those that are not in it were not reviewed.
        compared: the object of limits.json; None where no limits of the shop were told.
        inches: lengths in texts in inches instead of mm.
    """
    limits = {one["defect"]: one for one in (compared or {}).get("findings", ())}
    found = [
        {
            **_finding(record, source, reviews.get(f"D{record['id']}"), inches),
            "limits": _limits(limits.get(record["id"])),
        }
        for record in source.defects
    ]
    return sorted(found, key=lambda one: (one["size"]["value"] is None, -(one["size"]["value"] or 0.0), one["id"]))


def _limits(one: JsonObject | None) -> JsonObject | None:
    """How it compares with the limits of the shop; None where none were told."""
    if one is None:
        return None
    return {
        "verdict": one["verdict"],
        "reason": one["reason"],
        "text": f"{verdict_text(one['verdict'])}: {one['reason']}",
    }


def verdict_text(verdict: str) -> str:
    """How something compares with a limit, in words."""
    return str(verdict).replace("_", " ")


def _finding(record: JsonObject, source: ReportSource, review: Review | None, inches: bool) -> JsonObject:
    model = int(record.get("model") or 0)
    visits = [event for event in source.timeline if event["defect_id"] == record["id"]]
    seen = record.get("persistence") or {}
    confidence = record.get("confidence") or {}
    return {
        "id": record["id"],
        "name": f"D{record['id']}",
        "model": model,
        "label": record["label"],
        "place": _place(record, source, model, inches),
        "size": _size(record, inches),
        "width": _measure(record, "width", inches),
        "area": _measure(record, "area", inches),
        "depth": _measure(record, "depth", inches),
        "confidence": confidence.get("value"),
        "seen": {"frames": seen.get("k"), "could_show": seen.get("n")},
        "times": _times(visits),
        "human": human_object(review, inches=inches),
        "pictures": finding_pictures(source, record, model),
    }


def _place(record: JsonObject, source: ReportSource, model: int, inches: bool) -> JsonObject:
    """Where it lies on its blade. The row's own words; every part that is not known says so."""
    told = (source.rows.get(model) or {}).get("findings") or ()
    known: JsonObject = next((one for one in told if one.get("defect") == record["id"]), {})
    blade = record.get("blade")
    place: JsonObject = {"blade": blade, "relative": is_relative(blade, source)}
    for name in ("side", "span", "chord", "edge_distance", "root_distance"):
        origin = known if record.get(name) in _NO_PART else record
        value = origin.get(name)
        place[name] = None if value in _NO_PART else value
        if name != "side":
            place[f"{name}_sigma"] = origin.get(f"{name}_sigma")
    scale = _scale_unit(record)
    shares = [_share(place, "span", "of the span seen, from the root"), _share(place, "chord", "of the chord")]
    lengths = [
        _length(place, "root_distance", "from the root", scale, inches),
        _length(place, "edge_distance", "from the edge", scale, inches),
    ]
    place["text"] = "; ".join(
        [blade_text(blade, relative=place["relative"]), _side(place), *shares, *filter(None, lengths)]
    )
    return place


def is_relative(blade: str | None, source: ReportSource) -> bool:
    """Whether the number of a blade counts from the first one seen, as those of further models (`1-B4`) always do."""
    zero = (source.rows.get(0) or {}).get("zero_blade")
    return blade is not None and (not str(blade).isdecimal() or zero is None)


def blade_text(blade: object, *, relative: bool) -> str:
    """A blade in words; its number counts from the first blade seen unless a zero blade was told."""
    if blade is None:
        return f"blade {UNKNOWN}"
    return f"blade {blade} (relative)" if relative else f"blade {blade}"


def _side(place: JsonObject) -> str:
    return f"side {UNKNOWN}" if place["side"] is None else f"side: {str(place['side']).replace('_', ' ')}"


def _share(place: JsonObject, name: str, words: str) -> str:
    value, sigma = place[name], place[f"{name}_sigma"]
    if value is None:
        return f"{name} {UNKNOWN}"
    spread = "" if sigma is None else f" ± {100 * sigma:.0f}"
    return f"{100 * value:.0f}{spread} % {words}"


def _length(place: JsonObject, name: str, words: str, unit: str, inches: bool) -> str:
    value = place[name]
    return "" if value is None else f"{amount(value, place[f'{name}_sigma'], unit, inches=inches)} {words}"


def _scale_unit(record: JsonObject) -> str:
    return str(record.get("length_unit") or (record.get("extent") or {}).get("unit") or MODEL_UNIT)


def _size(record: JsonObject, inches: bool) -> JsonObject:
    """Its length along the surface, where none was measured its extent."""
    extent = record.get("extent") or {}
    if record.get("length") is not None:
        value, sigma, unit, kind = record["length"], record.get("length_sigma"), _scale_unit(record), "length"
    else:
        value, sigma, unit, kind = extent.get("value"), extent.get("sigma"), extent.get("unit") or MODEL_UNIT, "extent"
    return {
        "value": value,
        "sigma": sigma,
        "unit": unit,
        "kind": kind,
        "text": amount(value, sigma, unit, inches=inches),
    }


def _measure(record: JsonObject, name: str, inches: bool) -> JsonObject:
    value, sigma, unit = record.get(name), record.get(f"{name}_sigma"), _scale_unit(record)
    power = 2 if name == "area" else 1
    return {"value": value, "sigma": sigma, "text": amount(value, sigma, unit, power, inches=inches)}


def amount(value: float | None, sigma: float | None, unit: str, power: int = 1, *, inches: bool = False) -> str:
    """A measure with its standard deviation and unit; "unscaled" while lengths have none.

    Args:
        value: in the unit, None = unknown.
        sigma: the same.
        unit: of lengths.
        power: 2 for an area.
        inches: show it in inches where its unit is mm.
    """
    if value is None:
        return UNKNOWN
    if inches and unit == LengthUnit.MM:
        factor = MM_PER_INCH**-power
        value, sigma, unit = factor * value, None if sigma is None else factor * sigma, "in"
    if unit != MODEL_UNIT and power == 2:
        unit += "²"
    spread = f"± {UNKNOWN}" if sigma is None else f"± {sigma:.2g}"
    return f"{value:.3g} {spread} ({UNSCALED})" if unit == MODEL_UNIT else f"{value:.3g} {spread} {unit}"


def _times(visits: Sequence[JsonObject]) -> JsonObject:
    if not visits:
        return {"first_s": None, "last_s": None, "visits": 0, "text": UNKNOWN}
    first = min(visits, key=lambda one: (one.get("video") or 0, one["start_s"]))
    last = max(visits, key=lambda one: (one.get("video") or 0, one["end_s"]))
    several = any(one.get("video") for one in visits)
    text = f"{_instant(first, 'start_s', several)} to {_instant(last, 'end_s', several)}"
    many = f", {len(visits)} visits" if len(visits) > 1 else ""
    return {"first_s": first["start_s"], "last_s": last["end_s"], "visits": len(visits), "text": text + many}


def _instant(event: JsonObject, name: str, several: bool) -> str:
    at = f"{event[name]:.2f} s"
    return f"{at} of video {event.get('video') or 0}" if several else at


def human_object(review: Review | None, *, inches: bool = False) -> JsonObject:
    """What people say of a finding, beside what the machine says; None and "not reviewed" where they say nothing."""
    one = review or Review()
    said = one != Review()
    measure = one.measures[-1] if one.measures else None
    unit = MODEL_UNIT if measure is None else measure.get("unit") or MODEL_UNIT
    length = None if measure is None else amount(measure["length"], measure.get("sigma"), unit, inches=inches)
    into = f" into {one.merged_into}" if one.merged_into else ""
    return {
        "state": f"{one.state}{into}" if one.state != ReviewState.OPEN else "open" if said else NOT_REVIEWED,
        "decided": one.state != ReviewState.OPEN,
        "reason": one.reason or None,
        "label": one.label,
        "blade": one.blade,
        "length": length,
        "disposition": one.severity,
        "notes": [f"{note.text} ({note.by})" if note.by else note.text for note in one.notes],
        "by": one.by or None,
        "time": one.time or None,
    }


def added_objects(reviewed: Reviewed, *, inches: bool = False) -> list[JsonObject]:
    """Findings that people made: the machine has none of them."""
    return [_added(one, inches) for one in reviewed.findings if one.target.kind == TargetKind.ADDED]


def unattached_texts(reviewed: Reviewed) -> list[str]:
    """What was said of findings that the result does not have, in sentences."""
    return [_unattached(one.target, one.review) for one in reviewed.unattached]


def _added(one: ReviewedFinding, inches: bool) -> JsonObject:
    return {
        "name": one.name,
        "label": one.review.label or one.target.label,
        "human": human_object(one.review, inches=inches),
    }


def _unattached(target: Target, review: Review) -> str:
    human = human_object(review)
    said = [human["state"], human["reason"], human["label"], human["disposition"], *human["notes"]]
    return f"{target.label}: {'; '.join(text for text in said if text)}"
