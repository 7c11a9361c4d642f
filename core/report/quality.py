"""quality.json: can this result be trusted, what was lost, and the thesis's tables for the run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict

from core.checks.parallax import cases_parallax
from core.flags import Flag, Severity, Verdict, error_codes, in_order, verdict_by
from core.products.contract import Findings, read_product
from core.products.front import AnnotationsProduct, CameraProduct, ProbeProduct
from core.products.search import CaseProduct, ExtendProduct, RankedCases
from core.products.surface import MeshProduct, PlacesProduct
from core.report.losses import funnel, losses, missing_parts, support_counts
from core.report.record import Document, RunRecord, TaskRecord
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
    still = cases_parallax([case for kind in CaseKind for case in record.products.parts(CaseProduct, kind)])
    if still is not None:
        flags.append(still)
    for task in record.tasks:
        submodel = submodel_of(task.key)
        for flag in [*_flags_that_count(record, task), *_checks_that_count(record, task)]:
            flags.append(flag.of_model(submodel))
    return in_order(flags)


def _start_of_lens(record: RunRecord) -> str:
    """The task whose lens the model started from: another one where the search ended with a perspective lens."""
    return "reverify" if "reduce_perspective" in record.products else "camera"


def _flags_that_count(record: RunRecord, task: TaskRecord) -> Sequence[Flag]:
    """Of the lenses that were sought, the flags of the one that the model started from."""
    if task.key in ("camera", "reverify") and task.key != _start_of_lens(record):
        return ()
    return read_product(Findings, task.facts, task.key).flags


def _checks_that_count(record: RunRecord, task: TaskRecord) -> Sequence[Flag]:
    """Of the cases, the checks of the chosen one speak for the run, and only where no final model was made of it."""
    is_case = task.stage in tuple(CaseKind)
    if is_case and ("extend" in record.products or part_of(task.key) != selected_case(record)):
        return ()
    return read_product(Findings, task.facts, task.key).checks


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
    if record.reason == "no_reconstruction" or "extend" not in record.products:
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
    places, model = record.products.find(PlacesProduct, "map_defects"), record.products.find(ExtendProduct, "extend")
    support = support_counts(detections, None if places is None else places.unique_support_points)
    annotations = record.products.find(AnnotationsProduct, "annotations")
    return {
        "schema_version": SCHEMA_VERSION,
        "verdict": verdict,
        "state": record.state,
        "reason": record.reason or None,
        "flags": [flag.explained() for flag in flags],
        "checks": [] if model is None else [flag.to_dict() for flag in model.checks],
        "notes": _notes(record),
        "funnel": steps,
        "lost": losses(detections),
        "support": support,
        "time_convention": None if annotations is None else annotations.time_convention,
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
            record.products,
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
    probed = record.products.find(ProbeProduct, "probe")
    if probed is None or not probed.videos:
        return {}
    annotations = record.products.find(AnnotationsProduct, "annotations")
    registered = set(record.tables.registered)
    videos = []
    for number, length in enumerate(probed.videos):
        own = [frame.index for frame in record.tables.frames if frame.video == number]
        found = len(registered.intersection(own))
        videos.append({"video": number, **asdict(length), "frames": len(own), "registered": found})
    conventions = None if annotations is None else annotations.time_conventions
    return {"time_conventions": None if conventions is None else list(conventions), "videos": videos}


def _registration(record: RunRecord) -> dict[str, object]:
    """Registered shares, of the frames offered and of all frames of the video."""
    offered, registered = len(record.tables.frames), len(record.tables.registered)
    frames, registered_set = record.tables.frames, set(record.tables.registered)
    annotated = {row.source for row in record.tables.detections if row.source is not None}
    seen = {frame.source for frame in frames if frame.index in registered_set}
    probed = record.products.find(ProbeProduct, "probe")
    in_video = None if probed is None else probed.n_frames
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
    start = record.products.find(CameraProduct, _start_of_lens(record))
    final = record.products.find(ExtendProduct, "extend")
    return {
        "model": final.lens_model if final and final.lens_model else start.model if start else None,
        "params": list(final.lens_params) if final and final.lens_params else None,
        "from": start.focal_from if start else None,
        "held": not record.settings.mapper.refine_lens,
    }


def _models(record: RunRecord) -> list[dict[str, object]]:
    """The served models; the first is the run's own."""
    rows: list[dict[str, object]] = []
    for number in (0, *sorted(record.tables.registered_further)):
        model = record.products.find(ExtendProduct, key_of("extend", number))
        if model is not None:
            rows.append(
                {
                    "model": number,
                    "registered_images": model.registered_images,
                    "points3D": model.points3D,
                    "mean_reprojection_error_px": model.mean_reprojection_error_px,
                    "defects": sum(defect.model == number for defect in record.tables.defects),
                }
            )
    return rows


def _share(part: int, whole: int | None) -> float | None:
    return round(part / whole, 4) if whole else None


def _reprojection(record: RunRecord) -> dict[str, object]:
    model = record.products.find(ExtendProduct, "extend")
    return {
        "mean_px": None if model is None else model.mean_reprojection_error_px,
        "median_px": None if model is None else model.median_reprojection_error_px,
    }


def _surface(record: RunRecord) -> dict[str, object]:
    names = ("n_vertices", "n_faces", "diagonal_su", "point_spacing_su", "supported_share")
    mesh = record.products.find(MeshProduct, "mesh")
    return {name: None if mesh is None else getattr(mesh, name) for name in names}


def _losers(record: RunRecord, cases: Sequence[CaseRow]) -> list[dict[str, object]]:
    """The cases that were not selected, best first, each with why it lost.

    `verified_detections` is null for coarse cases, which lost before detections were asked for.
    """
    found = (record.products.find(RankedCases, reducer) for reducer in ("reduce_refine", "reduce_parts"))
    verified = {case.name: case.verified_detections for ranking in found if ranking for case in ranking.ranking}
    winner = next((row.name for row in cases if row.selected), "")
    checks = {
        part_of(task.key): read_product(Findings, task.facts, task.key).checks for task in record.of_stage(*CaseKind)
    }
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


def _why_lost(row: CaseRow, checks: Sequence[Flag], verified: int | None, of_winner: int | None) -> str:
    if not row.succeeded:
        return str(row.reason or row.status)
    if row.vetoed:
        return f"vetoed: {error_codes(checks)}"
    if verified is not None and of_winner is not None and verified < of_winner:
        return f"verified detections: {verified} against {of_winner}"
    return "score"
