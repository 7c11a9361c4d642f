"""Findings compared with the limits of the shop: a comparison of numbers, never a word on the part.

A finding is within a limit where its measure lies below it by two standard deviations, beyond it where it lies above by
as many, and else it cannot be told, as where the measure, the scale or the place is not known. Only people release or
reject parts.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import asdict, dataclass
from enum import StrEnum

from core.json_files import JsonObject
from core.report.tables import SCHEMA_VERSION
from core.scene.defect import DefectRecord
from core.scene.on_row import Side
from core.scene.size import MM_PER_INCH, LengthUnit, Measure
from core.settings.limits import ANY, Limit, zone_named

SIGMAS = 2.0
"""By so many standard deviations a measure has to lie below or above a limit."""


class LimitVerdict(StrEnum):
    """How a finding, or the findings on a blade, compare with a limit."""

    WITHIN = "within"
    BEYOND = "beyond"
    CANNOT_TELL = "cannot_tell"
    NO_LIMIT = "no_limit"
    """No row of the table is for it."""


_WORST = (LimitVerdict.BEYOND, LimitVerdict.CANNOT_TELL, LimitVerdict.WITHIN)


class _Applies(StrEnum):
    """Whether a limit is for a finding."""

    YES = "yes"
    NO = "no"
    UNKNOWN = "unknown"


@dataclass(frozen=True)
class LimitCheck:
    """One measure of a finding, or the findings on a blade, against one row of the table."""

    line: int
    """Of the table."""
    what: str
    """`length`, `depth` or `count`."""
    limit: float
    """mm; of a count the number."""
    value: float | None
    """mm, or the number; None where it is not known."""
    sigma: float | None
    verdict: LimitVerdict
    reason: str
    """A clause."""


_EDGES = (Side.EDGE, Side.LEADING_EDGE, Side.TRAILING_EDGE)
_BARE_EDGE = {Side.EDGE: (Side.LEADING_EDGE, Side.TRAILING_EDGE)}


def limits_document(limits: Sequence[Limit], records: Sequence[DefectRecord], *, inches: bool = False) -> JsonObject:
    """The object of ``limits.json``.

    Args:
        limits: of the shop.
        records: of all models.
        inches: write the lengths in the reasons in inches; numbers stay in mm.
    """
    findings = []
    for record in records:
        checks = [check for limit in limits for check in _checks(limit, record, inches)]
        verdict, reason = overall(checks)
        of_record = {"defect": record.id, "model": record.model, "verdict": verdict, "reason": reason}
        findings.append({**of_record, "checks": [asdict(check) for check in checks]})
    counts = [
        {"blade": blade, **asdict(check)}
        for limit in limits
        if limit.count is not None
        for blade, check in _counts(limit, limit.count, records)
    ]
    return {
        "schema_version": SCHEMA_VERSION,
        "sigmas": SIGMAS,
        "limits": [{**asdict(limit), "zone": limit.zone or ANY} for limit in limits],
        "findings": findings,
        "counts": counts,
    }


def limits_of(document: JsonObject) -> tuple[Limit, ...]:
    """The limits that an object of ``limits.json`` was made with."""
    return tuple(Limit(**{**row, "zone": zone_named(row["zone"])}) for row in document["limits"])


def overall(checks: Sequence[LimitCheck]) -> tuple[LimitVerdict, str]:
    """The worst verdict, and the reasons of those that have it."""
    if not checks:
        return LimitVerdict.NO_LIMIT, "no row of the table limits its length or depth"
    worst = min((check.verdict for check in checks), key=_WORST.index)
    return worst, "; ".join(dict.fromkeys(check.reason for check in checks if check.verdict == worst))


def _checks(limit: Limit, record: DefectRecord, inches: bool) -> Iterable[LimitCheck]:
    applies, why = _applies(limit, record)
    if applies == _Applies.NO:
        return
    for what, most in (("length", limit.length_mm), ("depth", limit.depth_mm)):
        if most is not None:
            yield _check(limit.line, what, most, record, why, inches)


def _check(line: int, what: str, most: float, record: DefectRecord, unsure: str, inches: bool) -> LimitCheck:
    """One measure against its largest value; `unsure` says why the limit may not be for the finding, else empty."""
    measure = None if record.size is None else record.size.measures.get(what)
    unit = LengthUnit.MODEL if record.size is None else record.size.unit

    def told(verdict: LimitVerdict, reason: str) -> LimitCheck:
        known = measure is not None and unit == LengthUnit.MM
        value, sigma = (measure.value, measure.sigma) if measure is not None and known else (None, None)
        return LimitCheck(line, what, most, value, sigma, verdict, reason)

    if measure is None:
        return told(LimitVerdict.CANNOT_TELL, f"its {what} is not known")
    if unit != LengthUnit.MM:
        return told(LimitVerdict.CANNOT_TELL, f"no scale is known, so its {what} is not known in millimetres")
    verdict = compared(measure, most)
    factor, shown = (1.0 / MM_PER_INCH, "in") if inches else (1.0, "mm")
    words = f"its {what} of {factor * measure.value:.3g} ± {factor * measure.sigma:.2g} {shown}"
    row = f"the {factor * most:.4g} {shown} of line {line}"
    if verdict == LimitVerdict.WITHIN:
        return told(verdict, f"{words} is below {row}")
    if verdict == LimitVerdict.CANNOT_TELL:
        return told(verdict, f"{words} is too near to {row}")
    if unsure:
        return told(LimitVerdict.CANNOT_TELL, f"{words} is above {row}, but {unsure}")
    return told(verdict, f"{words} is above {row}")


def compared(measure: Measure, most: float) -> LimitVerdict:
    """A measure against its largest value, in one unit."""
    if measure.value + SIGMAS * measure.sigma <= most:
        return LimitVerdict.WITHIN
    return LimitVerdict.BEYOND if measure.value - SIGMAS * measure.sigma > most else LimitVerdict.CANNOT_TELL


def _counts(limit: Limit, most: int, records: Sequence[DefectRecord]) -> Iterable[tuple[str | None, LimitCheck]]:
    """Findings that a limit is or may be for, by blade; None is the blade that is not known."""
    sure: dict[str | None, int] = {}
    perhaps: dict[str | None, int] = {}
    for record in records:
        applies, _ = _applies(limit, record)
        if applies != _Applies.NO:
            sure[record.blade] = sure.get(record.blade, 0) + (applies == _Applies.YES)
            perhaps[record.blade] = perhaps.get(record.blade, 0) + (applies == _Applies.UNKNOWN)
    lost = sure.get(None, 0) + perhaps.get(None, 0)
    for blade in sorted(sure, key=str):
        yield blade, _count(limit.line, most, blade, sure[blade], perhaps[blade], lost if blade is not None else 0)


def _count(line: int, most: int, blade: str | None, sure: int, perhaps: int, lost: int) -> LimitCheck:
    """The findings on one blade; `perhaps` may be of the kind, `lost` on this blade."""
    on = f"on blade {blade}" if blade is not None else "on blades that are not known"
    more = perhaps + lost
    if blade is None:
        verdict = LimitVerdict.WITHIN if sure + perhaps <= most else LimitVerdict.CANNOT_TELL
    elif sure > most:
        verdict = LimitVerdict.BEYOND
    else:
        verdict = LimitVerdict.WITHIN if sure + more <= most else LimitVerdict.CANNOT_TELL
    also = f" and {more} more that may be of them" if more else ""
    reason = f"{sure}{also} {on} were found, {most} are allowed by line {line}"
    return LimitCheck(line, "count", most, sure, None, verdict, reason)


def _applies(limit: Limit, record: DefectRecord) -> tuple[_Applies, str]:
    """Whether a limit is for a finding, and why that cannot be told, else an empty text."""
    if limit.damage.casefold() not in (ANY, record.label.casefold()):
        return _Applies.NO, ""
    found = [(_in_zone(limit.zone, record.on_row.side), "its side is not known well enough"), _in_span(limit, record)]
    if any(one == _Applies.NO for one, _ in found):
        return _Applies.NO, ""
    unsure = [why for one, why in found if one == _Applies.UNKNOWN]
    return (_Applies.UNKNOWN, " and ".join(unsure)) if unsure else (_Applies.YES, "")


def _in_zone(zone: Side | None, side: Side | None) -> _Applies:
    if zone in (None, side) or (zone == Side.EDGE and side in _EDGES):
        return _Applies.YES
    if side is None or side == Side.UNKNOWN or zone in _BARE_EDGE.get(side, ()):
        return _Applies.UNKNOWN
    return _Applies.NO


def _in_span(limit: Limit, record: DefectRecord) -> tuple[_Applies, str]:
    if (limit.span_from, limit.span_to) == (0.0, 1.0):
        return _Applies.YES, ""
    span, sigma = record.on_row.span, record.on_row.span_sigma
    if span is None or sigma is None:
        return _Applies.UNKNOWN, "its span is not known"
    low, high = span - SIGMAS * sigma, span + SIGMAS * sigma
    if high < limit.span_from or low > limit.span_to:
        return _Applies.NO, ""
    inside = (limit.span_from == 0.0 or low >= limit.span_from) and (limit.span_to == 1.0 or high <= limit.span_to)
    return (_Applies.YES, "") if inside else (_Applies.UNKNOWN, "its span is too near to the end of the zone")


def limit_text(limit: JsonObject, *, inches: bool = False) -> str:
    """A row of the table in words."""
    zone = "anywhere" if limit["zone"] == ANY else str(limit["zone"]).replace("_", " ")
    where = (
        zone
        if (limit["span_from"], limit["span_to"]) == (0.0, 1.0)
        else (f"{zone}, span {limit['span_from']:.0%} to {limit['span_to']:.0%}")
    )
    factor, unit = (1.0 / MM_PER_INCH, "in") if inches else (1.0, "mm")
    parts = [
        f"{name} at most {factor * limit[f'{name}_mm']:.4g} {unit}"
        for name in ("length", "depth")
        if limit[f"{name}_mm"] is not None
    ]
    parts += [] if limit["count"] is None else [f"at most {limit['count']} on a blade"]
    return f"{limit['damage']}, {where}: {', '.join(parts)}"
