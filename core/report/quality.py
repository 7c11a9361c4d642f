"""quality.json: can this result be trusted, what was lost, and the thesis's tables for the run."""

from __future__ import annotations

from collections.abc import Sequence

from core.checks.parallax import cases_parallax
from core.flags import Flag, FlagFields, Severity, Verdict, error_codes, in_order, verdict_by
from core.report.losses import funnel, losses, missing_parts, support_counts
from core.report.record import Document, Row, RunRecord, TaskRecord
from core.report.rows import selected_case
from core.report.tables import SCHEMA_VERSION
from core.scene.case import CaseKind, CaseRow
from core.scene.detection import DetectionRow, Outcome
from core.task_key import key_of, part_of, submodel_of
from core.thesis.search import refinement_gain, spread, weak_cases
from core.thesis.tables import thesis_tables


def collect_flags(record: RunRecord) -> list[Flag]:
    """All flags that stages raised (facts `flags` and `checks`), of the search, of the settings, of what is missing.

    Worst first, none twice.
    """
    flags = [*_settings_flags(record), *missing_parts(record)]
    flags += _several_models(record)
    still = cases_parallax([task.facts for task in record.tasks if task.stage in tuple(CaseKind) and task.facts])
    if still is not None:
        flags.append(still)
    for task in record.tasks:
        submodel = submodel_of(task.key)
        for row in [*_flags_that_count(record, task), *_checks_that_count(record, task)]:
            flags.append(Flag.from_dict(row).of_model(submodel))
    return in_order(flags)


def _start_of_lens(record: RunRecord) -> str:
    """The task whose lens the model started from: another one where the search ended with a perspective lens."""
    return "reverify" if record.facts("reduce_perspective") else "camera"


def _flags_that_count(record: RunRecord, task: TaskRecord) -> Sequence[FlagFields]:
    """Of the lenses that were sought, the flags of the one that the model started from."""
    if task.key in ("camera", "reverify") and task.key != _start_of_lens(record):
        return ()
    flags: Sequence[FlagFields] = task.facts.get("flags", ())
    return flags


def _checks_that_count(record: RunRecord, task: TaskRecord) -> Sequence[FlagFields]:
    """Of the cases, the checks of the chosen one speak for the run, and only where no final model was made of it."""
    is_case = task.stage in tuple(CaseKind)
    if is_case and (record.facts("extend") or part_of(task.key) != selected_case(record)):
        return ()
    checks: Sequence[FlagFields] = task.facts.get("checks", ())
    return checks


def _several_models(record: RunRecord) -> list[Flag]:
    """Whether more than one model holds detections or defects."""
    holding = {row.model for row in record.tables.mapped_rows or () if row.outcome != Outcome.UNPLACED}
    numbers = sorted(number for number in holding | {one.model for one in record.tables.defects} if number is not None)
    if len(numbers) < 2:
        return []
    where = f"models {', '.join(map(str, numbers))}"
    return [Flag("several_models", Severity.WARNING, len(numbers), 1, where)]


def _settings_flags(record: RunRecord) -> list[Flag]:
    """The two coordinate mistakes that the preset `thesis` keeps."""
    flags = []
    if record.settings.mapping.box_frame == "crop":
        flags.append(Flag("boxes_in_crop_frame", Severity.WARNING, where="mapping.box_frame"))
    if _point_at_crop_centre(record):
        flags.append(Flag("principal_point_at_crop_centre", Severity.WARNING, where="camera.principal_point"))
    return flags


def _point_at_crop_centre(record: RunRecord) -> bool:
    """Whether the principal point started at the centre of the crop; that of a calibration does not."""
    return record.settings.camera.principal_point == "crop" and record.settings.camera.params is None


def verdict_of(record: RunRecord, flags: Sequence[Flag]) -> Verdict:
    """`refused` without a model to trust, `suspect` with any warning or error, else `ok`."""
    if record.reason == "no_reconstruction" or not record.facts("extend"):
        return Verdict.REFUSED
    return verdict_by(flags)


def build_quality(
    record: RunRecord,
    verdict: Verdict,
    flags: Sequence[Flag],
    cases: Sequence[CaseRow],
    detections: Sequence[DetectionRow],
) -> Document:
    """The object of quality.json. Unknown = null; nothing is guessed."""
    defects = [] if verdict == Verdict.REFUSED else record.tables.defects
    steps = funnel(detections, defects, record.settings.mapping.method)
    support = support_counts(detections, record.facts("map_defects").get("unique_support_points"))
    return {
        "schema_version": SCHEMA_VERSION,
        "verdict": verdict,
        "state": record.state,
        "reason": record.reason or None,
        "flags": [{**flag.to_dict(), "meaning": flag.meaning} for flag in flags],
        "checks": list(record.facts("extend").get("checks", ())),
        "notes": _notes(record),
        "funnel": steps,
        "lost": losses(detections),
        "support": support,
        "time_convention": record.facts("annotations").get("time_convention"),
        **_of_several_videos(record),
        "lens": _lens(record),
        "registration": _registration(record),
        "models": _models(record),
        "reprojection_error": _reprojection(record),
        "surface": _surface(record),
        "search": {
            "coarse": spread(cases, CaseKind.COARSE),
            "refined": spread(cases, CaseKind.REFINE),
            "parts": spread(cases, CaseKind.SECTION),
            "gain": refinement_gain(cases),
            "weak": weak_cases(cases),
            "losers": _losers(record, cases),
        },
        "tables": thesis_tables(
            record.facts,
            record.settings,
            selected_case(record),
            cases,
            detections,
            steps,
            support,
            len(record.tables.timeline),
        ),
    }


def _notes(record: RunRecord) -> list[str]:
    notes = []
    if record.settings.mapping.box_frame == "crop":
        notes.append(
            "Boxes are normalised on the source frame but were scaled to the cropped image, as the thesis appears to "
            "do; most places are wrong by it. The default preset transforms them exactly."
        )
    if _point_at_crop_centre(record):
        notes.append(
            "The principal point started at the centre of the off-centre crop, as the thesis appears to do. The "
            "default preset starts from the source frame's centre minus the crop offset."
        )
    if record.settings.camera.params is not None:
        held = "the lens was held" if not record.settings.mapper.refine_lens else "the lens was refined from there"
        notes.append(f"The lens is that of a calibration ({record.settings.camera.model}); {held}.")
    if record.settings.overrides:
        notes.append(f"Preset {record.settings.preset} with overrides: {', '.join(record.settings.overrides)}.")
    return notes


def _of_several_videos(record: RunRecord) -> Document:
    """What is told of each video where there are several: how its keys were read, and its share of the frames."""
    if len(record.facts("probe").get("videos", ())) < 2:
        return {}
    registered = set(record.tables.registered)
    videos = []
    for number, facts in enumerate(record.facts("probe")["videos"]):
        own = [frame.index for frame in record.tables.frames if frame.video == number]
        found = len(registered.intersection(own))
        videos.append({"video": number, **facts, "frames": len(own), "registered": found})
    return {"time_conventions": record.facts("annotations").get("time_conventions"), "videos": videos}


def _registration(record: RunRecord) -> dict[str, object]:
    """Registered shares, of the frames offered and of all frames of the video."""
    offered, registered = len(record.tables.frames), len(record.tables.registered)
    frames, registered_set = record.tables.frames, set(record.tables.registered)
    annotated = {row.source for row in record.tables.detections if row.source is not None}
    seen = {frame.source for frame in frames if frame.index in registered_set}
    in_video = record.facts("probe").get("n_frames")
    return {
        "frames_in_video": in_video,
        "frames": offered,
        "registered": registered,
        "share_of_frames": _share(registered, offered),
        "share_of_video": _share(registered, in_video),
        "annotated_frames": len(annotated),
        "annotated_registered": len(annotated & seen),
        "share_of_annotated": _share(len(annotated & seen), len(annotated)),
    }


def _lens(record: RunRecord) -> dict[str, object]:
    """The lens of model 0, on the crop, where it started, and whether it was held there."""
    start, final = record.facts(_start_of_lens(record)), record.facts("extend")
    return {
        "model": final.get("lens_model", start.get("model")),
        "params": final.get("lens_params"),
        "from": start.get("focal_from"),
        "held": not record.settings.mapper.refine_lens,
    }


def _models(record: RunRecord) -> list[dict[str, object]]:
    """The served models; the first is the run's own."""
    rows = []
    for number in (0, *sorted(record.tables.registered_further)):
        facts = record.facts(key_of("extend", number))
        if facts:
            names = ("registered_images", "points3D", "mean_reprojection_error_px")
            own = sum(defect.model == number for defect in record.tables.defects)
            rows.append({"model": number, **{name: facts.get(name) for name in names}, "defects": own})
    return rows


def _share(part: int, whole: int | None) -> float | None:
    return round(part / whole, 4) if whole else None


def _reprojection(record: RunRecord) -> dict[str, object]:
    facts = record.facts("extend")
    return {
        "mean_px": facts.get("mean_reprojection_error_px"),
        "median_px": facts.get("median_reprojection_error_px"),
    }


def _surface(record: RunRecord) -> dict[str, object]:
    names = ("n_vertices", "n_faces", "diagonal_su", "point_spacing_su", "supported_share")
    facts = record.facts("mesh")
    return {name: facts.get(name) for name in names}


def _losers(record: RunRecord, cases: Sequence[CaseRow]) -> list[dict[str, object]]:
    """The cases that were not selected, best first, each with why it lost.

    `verified_detections` is null for coarse cases, which lost before detections were asked for.
    """
    ranked = [row for reducer in ("reduce_refine", "reduce_parts") for row in record.facts(reducer).get("ranking", ())]
    verified = {row["name"]: row.get("verified_detections") for row in ranked}
    winner = next((row.name for row in cases if row.selected), "")
    checks = {part_of(task.key): task.facts.get("checks", ()) for task in record.of_stage(*CaseKind)}
    order = sorted(
        (row for row in cases if not row.selected),
        key=lambda row: (
            bool(row.vetoed),
            -(verified.get(row.name) or 0),
            -row.registered_images,
            -row.points3D,
            row.name,
        ),
    )
    return [
        {
            "name": row.name,
            "status": row.status,
            "registered_images": row.registered_images,
            "points3D": row.points3D,
            "verified_detections": verified.get(row.name),
            "why": _why_lost(row, checks[row.name], verified.get(row.name), verified.get(winner)),
        }
        for row in order
    ]


def _why_lost(row: CaseRow, checks: Sequence[Row], verified: int | None, of_winner: int | None) -> str:
    if not row.succeeded:
        return str(row.reason or row.status)
    if row.vetoed:
        return f"vetoed: {error_codes(checks)}"
    if verified is not None and of_winner is not None and verified < of_winner:
        return f"verified detections: {verified} against {of_winner}"
    return "score"
