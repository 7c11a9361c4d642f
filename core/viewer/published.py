"""The page of a result that has none yet, built from its published files and, for the pictures, from its videos."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

from core.errors import BadInput, StageFailed
from core.fingerprint import digest_of_file
from core.flags import Verdict
from core.json_files import JsonObject, read_json
from core.mapping.facing import read_surface
from core.outputs import (
    CONFIDENCE,
    DEFECT_SURFACE,
    DEFECTS,
    DETECTIONS,
    FRAMES,
    LIMITS,
    QUALITY,
    ROW,
    SPARSE,
    SPRITE,
    SUMMARY,
    SURFACE,
    SURFACE_GLB,
    TIMELINE,
    VIEWER,
    model_folder,
    model_numbers,
)
from core.report.build import Report
from core.report.csv_form import read_csv
from core.scene.defect import DefectRecord
from core.scene.frame import Crop, Frame, Role, RunFrames, image_name
from core.surface.ply import read_mesh
from core.video.factory import open_video
from core.video.probe import probe_video
from core.video.shown import shown_frames
from core.videos import input_role
from core.viewer.build import with_blades, write_scene
from core.viewer.deliver import write_page
from core.viewer.document import ViewerSource
from core.viewer.pictures import U8, write_pictures
from core.viewer.scene import FRAMES as PICTURES
from core.viewer.scene import FULL, SCENE_FILE, DrawnDetection, Pictures, ViewerScene, best_frames


def build_pages(folder: Path, videos: Sequence[Path] = ()) -> list[str]:
    """Write the pages of a finished result below it, one for each of its models.

    Args:
        folder: the result.
        videos: its videos in the order of the run; without them there are no pictures.

    Returns:
        What the pages lack, in sentences.

    Raises:
        BadInput: a file is missing that the page cannot do without, or a video is not the result's.
    """
    report = _report(folder)
    crop = _crop(report)
    models = model_numbers(folder) if report.verdict != Verdict.REFUSED else [0]
    said: list[str] = []
    with tempfile.TemporaryDirectory(prefix=".viewer-", dir=folder) as temporary:
        work = Path(temporary)
        pictures, why = (_pictures(report, videos, work), None) if videos else (None, _NO_PICTURES)
        if why:
            said.append(why)
        for model in models:
            made = work / str(model)
            made.mkdir()
            scene = _scene(folder, model, report, crop, made, said)
            if pictures is not None:
                scene = _with_pictures(work, made, model, scene, report)
                if model == 0 and scene is not None:
                    pictures = pictures.with_full(scene.full)
            source = ViewerSource(
                report,
                scene,
                pictures,
                model,
                tuple(models),
                _object(model_folder(folder, model) / ROW),
                _sigmas(model_folder(folder, model) / CONFIDENCE),
                why,
            )
            write_page(made, source, made / SURFACE_GLB)
            (made / SCENE_FILE).unlink(missing_ok=True)
            target = model_folder(folder, model) / VIEWER
            shutil.rmtree(target, ignore_errors=True)
            made.rename(target)
    return said


_NO_PICTURES = "this result keeps no clean pictures of its frames: name its video with --video to have them"


def _report(folder: Path) -> Report:
    """The published tables as the report that wrote them."""
    needed = (SUMMARY, QUALITY, FRAMES, DETECTIONS, TIMELINE, DEFECTS)
    missing = [name for name in needed if not (folder / name).is_file()]
    if missing:
        raise BadInput(f"{folder.name} has no {', '.join(missing)}: is it a finished result?", where=missing[0])
    try:
        summary, quality = read_json(folder / SUMMARY), read_json(folder / QUALITY)
        detections, timeline, defects = (read_json(folder / name) for name in (DETECTIONS, TIMELINE, DEFECTS))
        frames = [_frame_row(row) for row in read_csv(folder / FRAMES)]
    except (OSError, ValueError, KeyError) as error:
        raise BadInput(f"a table of {folder.name} cannot be read: {error}", where=folder.name) from None
    limits = _object(folder / LIMITS)
    return Report(Verdict(quality["verdict"]), summary, quality, frames, (), detections, timeline, defects, limits)


def _frame_row(row: dict[str, str]) -> dict[str, str | int | float | None]:
    """A row of frames.csv with its numbers; older ones have no video and only one model."""
    model = int(row["model"]) if row.get("model") else None
    numbers = {name: int(row[name]) for name in ("index", "source_index", "pts", "registered")}
    return {**row, **numbers, "time_s": float(row["time_s"]), "model": model, "video": int(row.get("video") or 0)}


def _crop(report: Report) -> Crop | None:
    frame = report.summary.get("frame") or {}
    if not frame.get("crop") or not frame.get("width"):
        return None
    x0, y0, x1, y1 = frame["crop"]
    return Crop(x0, y0, x1, y1, frame["width"], frame["height"])


def _scene(
    folder: Path, model: int, report: Report, crop: Crop | None, made: Path, said: list[str]
) -> ViewerScene | None:
    """The surface and poses of a model, written below `made`; None when the result lacks what they are made of."""
    root = model_folder(folder, model)
    if report.verdict == Verdict.REFUSED:
        return None
    missing = [name for name in (SPARSE, SURFACE, DEFECT_SURFACE) if not (root / name).exists()]
    if crop is None or missing:
        what = ", ".join(missing) if missing else f"part of the frames in its {SUMMARY}"
        said.append(f"model {model} has no {what}: its page has no surface")
        return None
    records = [DefectRecord.from_dict(dict(one)) for one in report.defects if int(one.get("model") or 0) == model]
    try:
        facing, views = read_surface(root / SPARSE, root / SURFACE)
        mesh = with_blades(facing, read_mesh(root / DEFECT_SURFACE))
        return write_scene(made, mesh, views, crop, records)
    except StageFailed as error:
        raise BadInput(error.message, where=root.name) from None


def _object(path: Path) -> JsonObject | None:
    return read_json(path) if path.is_file() else None


def _sigmas(path: Path) -> dict[int, float | None]:
    """Standard deviation of the place of every placed detection, model units."""
    return {row["id"]: row["position_sigma"] for row in read_json(path)} if path.is_file() else {}


def _pictures(report: Report, videos: Sequence[Path], work: Path) -> Pictures:
    """Pictures of all frames, decoded again from the result's own videos."""
    rows = [{**row, "role": Role.SAMPLED} for row in report.frames]
    names = ("index", "source_index", "pts", "time_s", "sha256", "role", "video")
    frames = RunFrames(tuple(Frame(**{name: row[name] for name in names}) for row in rows))  # type: ignore[arg-type]  # a table's cells
    _require_same(report, videos, frames)
    shown = {int(row["id"]): DrawnDetection(row["frame_index"], None) for row in report.detections}  # type: ignore[arg-type]
    return write_pictures(work, _decoded(videos, frames), shown)


def _require_same(report: Report, videos: Sequence[Path], frames: RunFrames) -> None:
    inputs = report.summary.get("inputs") or {}
    expected = [inputs.get(input_role("video", number)) for number in range(max(frames.videos, default=0) + 1)]
    if len(videos) != len(expected):
        raise BadInput(f"the result is of {len(expected)} videos, {len(videos)} are named", where="--video")
    for path, digest in zip(videos, expected, strict=True):
        if not path.is_file():
            raise BadInput(f"the video '{path.name}' is not there", where="--video")
        if digest and digest_of_file(path) != digest:
            raise BadInput(f"'{path.name}' is not the video of this result: its hash is another", where="--video")


def _decoded(videos: Sequence[Path], frames: RunFrames) -> Iterator[tuple[int, U8]]:
    for video, path in enumerate(videos):
        info = probe_video(path).info
        wanted = {frame.source_index: frame.index for frame in frames if frame.video == video}
        with open_video(path) as reader:
            for shown in shown_frames(reader.frames(), info):
                if shown.decoded.index in wanted:
                    yield wanted.pop(shown.decoded.index), shown.rgb()
                if not wanted:
                    break


def _with_pictures(work: Path, made: Path, model: int, scene: ViewerScene | None, report: Report) -> ViewerScene | None:
    """Move the pictures beside the first model's page, and the best views at full size beside every model's own."""
    (made / PICTURES).mkdir()
    wanted: set[int] = set()
    for record in report.defects:
        if int(record.get("model") or 0) == model:
            wanted |= set(best_frames(DefectRecord.from_dict(dict(record))))
    kept = [index for index in sorted(wanted) if (work / FULL / image_name(index)).is_file()]
    if model == 0:
        for path in sorted((work / PICTURES).iterdir()):
            shutil.copyfile(path, made / PICTURES / path.name)
        if (work / SPRITE).is_file():
            shutil.copyfile(work / SPRITE, made / SPRITE)
    for index in kept:
        shutil.copyfile(work / FULL / image_name(index), made / PICTURES / image_name(index))
    return None if scene is None else replace(scene, full=tuple(kept))
