"""Stage `gallery`: boxes on the original frames, and the coloured surface from two sides."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import cv2
import numpy as np

from core.errors import DiskFull
from core.gallery.boxes import FrameBoxes, choose_frames, draw_boxes, draw_defect_numbers, draw_place, group_by_frame
from core.gallery.defects import DefectLine, defect_lines
from core.gallery.evidence import Evidence, draw_evidence, evidence_of
from core.gallery.page import gallery_page
from core.gallery.palette import RGB, label_colors
from core.io.annotations import read_detections, read_rows
from core.io.frames import read_frames
from core.io.sparse import read_poses
from core.io.surface import defect_mesh
from core.io.timeline import read_defects, read_events
from core.outputs import ROW_MAP
from core.products.surface import GalleryProduct
from core.render import Renderer
from core.report.load import join_detections
from core.scene.frame import SourceFrame
from core.stage import StageTask
from core.surface.ply import read_mesh
from core.task_key import stage_of
from core.video.factory import reopen_video
from core.video.shown import ShownFrame, shown_frames
from core.video.table import read_infos
from core.videos import named
from core.viewpoint import choose_two

MIN_SUPPORT = 0.5
"""Surface below this support is drawn but does not decide what a picture is framed on."""


def run(task: StageTask) -> GalleryProduct:
    """Write the page, a picture per chosen frame and per best frame, two renderings."""
    settings = task.settings.gallery
    timelines = [folder for key, folder in sorted(task.inputs.items()) if stage_of(key) == "timeline"]
    rows = join_detections([read_rows(folder) for folder in timelines])
    source = {one.id: one.source for one in read_detections(task.input("annotations"))}
    frames = group_by_frame(rows, source)
    chosen = choose_frames(frames, settings.max_frames)
    colors = label_colors([row.label for row in rows])
    records = [record for folder in timelines for record in read_defects(folder)]
    events = [event for folder in timelines for event in read_events(folder)]
    used = read_frames(task.input("frames"))
    defects = defect_lines(records, events, used)
    rank = {line.number: position for position, line in enumerate(defects)}
    records = sorted(records, key=lambda record: rank[record.id])
    evidence = evidence_of(records, rows) if task.settings.mapping.method == "surface" else []
    pictures = _pictures(chosen, frames, defects)
    evidence_at: dict[SourceFrame, list[Evidence]] = {}
    for one in evidence:
        evidence_at.setdefault(used[one.frame_index].source, []).append(one)
    _write_frames(task, pictures, colors, evidence_at)
    _write_views(task)
    drawn = task.input("timeline") / ROW_MAP
    row_map = drawn.read_text(encoding="utf-8") if drawn.is_file() else ""
    page = gallery_page(chosen, len(frames), rows, defects, colors, evidence, len(task.recordings), row_map)
    (task.out / "index.html").write_text(page, encoding="utf-8", newline="\n")
    return GalleryProduct(n_images=len(chosen), n_frames=len(frames))


@dataclass(frozen=True)
class _Picture:
    """What is drawn on one frame."""

    boxes: FrameBoxes
    marks: tuple[tuple[int, tuple[float, float]], ...]
    """Defects that it shows best without a box of theirs, with their normalised places."""


def _pictures(
    chosen: Sequence[FrameBoxes], frames: Sequence[FrameBoxes], defects: Sequence[DefectLine]
) -> dict[SourceFrame, _Picture]:
    """The chosen frames and the best frame of every defect, by source frame."""
    boxes = {frame.source: frame for frame in chosen}
    known = {frame.source: frame for frame in frames}
    marks: dict[SourceFrame, list[tuple[int, tuple[float, float]]]] = {}
    for line in defects:
        if line.best is None:
            continue
        at = line.best.source
        frame = boxes.setdefault(at, known.get(at) or FrameBoxes(at, line.best.time_s, ()))
        if line.best.place is not None and all(row.defect_id != line.number for row in frame.rows):
            marks.setdefault(at, []).append((line.number, line.best.place))
    return {at: _Picture(frame, tuple(marks.get(at, ()))) for at, frame in boxes.items()}


def _write_frames(
    task: StageTask,
    pictures: Mapping[SourceFrame, _Picture],
    colors: Mapping[str, RGB],
    evidence: Mapping[SourceFrame, Sequence[Evidence]],
) -> None:
    """Decode every video once, in order, and write the frames with their boxes, and the evidence of defects."""
    quality = [cv2.IMWRITE_JPEG_QUALITY, task.settings.gallery.jpeg_quality]
    for source, shown in _decoded(task, [*pictures, *evidence]):
        picture = pictures.get(source)
        if picture is not None:
            drawn = draw_boxes(shown.rgb(), picture.boxes.rows, colors)
            for number, place in picture.marks:
                drawn = draw_place(drawn, number, place)
            _write_image(task, picture.boxes.file_name, drawn, quality)
        for one in evidence.get(source, ()):
            _write_image(task, one.file_name, draw_evidence(shown.rgb(), one), quality)


def _decoded(task: StageTask, wanted: Collection[SourceFrame]) -> Iterator[tuple[SourceFrame, ShownFrame]]:
    """Frames of every video up to the last wanted one of each."""
    total = len(task.recordings)
    for video, info in enumerate(read_infos(task.input("probe"))):
        last = max((source.source_index for source in wanted if source.video == video), default=-1)
        if last < 0:
            continue
        with reopen_video(task.recordings[video].video, info, max_pixels=task.max_frame_pixels) as reader:
            for shown in shown_frames(reader.frames(), info):
                index = shown.decoded.index
                yield SourceFrame(video, index), shown
                share = (video + index / (last + 1)) / total
                task.report(0.5 * share, 1, named(f"frame {index} of {last}", video, total))
                if index >= last:
                    break


def _write_views(task: StageTask) -> None:
    """Render the surface from two sides from which its defects are seen."""
    mesh = read_mesh(defect_mesh(task.input("timeline")))
    poses = read_poses(task.input("timeline"))
    renderer = Renderer(mesh, task.threads)
    if renderer.front_share(poses) < 0.5:  # a surface turned inside out would show its grey back
        renderer = Renderer(replace(mesh, faces=np.ascontiguousarray(mesh.faces[:, ::-1])), task.threads)
    width, height = task.settings.gallery.render_width_px, task.settings.gallery.render_height_px
    supported = mesh.extra.get("support", np.ones(len(mesh.vertices))) >= MIN_SUPPORT
    points = mesh.vertices[supported] if supported.any() else mesh.vertices
    views = choose_two(renderer.sketch, points, poses, width / height)
    for number, view in enumerate(views, start=1):
        task.report(0.5 + number / 5, 1, f"view {number} of the surface")
        picture = renderer.render(view, width, height)
        marked = draw_defect_numbers(picture.rgb, picture.defect)
        _write_image(task, f"mesh_{number}.png", marked, [cv2.IMWRITE_PNG_COMPRESSION, 6])


def _write_image(task: StageTask, name: str, rgb: np.ndarray, options: list[int]) -> None:
    path = task.out / name
    if not cv2.imwrite(str(path), cv2.cvtColor(rgb, cv2.COLOR_RGB2BGR), options):
        raise DiskFull(f"{name} could not be written", where=task.key)
