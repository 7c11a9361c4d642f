"""Stage `gallery`: boxes on the original frames, and the coloured surface from two sides."""

from __future__ import annotations

from dataclasses import replace

import cv2
import numpy as np

from core.errors import DiskFull
from core.gallery.boxes import FrameBoxes, choose_frames, draw_boxes, draw_defect_numbers, group_by_frame
from core.gallery.evidence import Evidence, draw_evidence, evidence_of
from core.gallery.page import gallery_page
from core.gallery.palette import label_colors
from core.mapping.rows import DetectionRow
from core.render import Renderer
from core.report.models import join_detections, join_lists
from core.report.tables import read_json
from core.stage import StageResult, StageTask, stage_of
from core.surface.ply import read_mesh
from core.video.decode import VideoReader
from core.viewpoint import choose_two

MIN_SUPPORT = 0.5
"""Surface below this support is drawn but does not decide what a picture is framed on."""


def run(task: StageTask) -> StageResult:
    """Write the page, one picture per chosen frame and two renderings. Facts: n_images, n_frames."""
    settings = task.settings.gallery
    timelines = [folder for key, folder in sorted(task.inputs.items()) if stage_of(key) == "timeline"]
    rows = [DetectionRow(**row) for row in join_detections([read_json(f / "detections.json") for f in timelines])]
    source = {row["id"]: row["source_index"] for row in read_json(task.input("annotations") / "detections.json")}
    frames = group_by_frame(rows, source)
    chosen = choose_frames(frames, settings.max_frames)
    colors = label_colors([row.label for row in rows])
    defects = join_lists([read_json(folder / "defects.json") for folder in timelines])
    evidence = evidence_of(defects, rows) if task.settings.mapping.method == "surface" else []
    _write_frames(task, chosen, colors, evidence)
    _write_views(task)
    events = join_lists([read_json(folder / "timeline.json") for folder in timelines])
    page = gallery_page(chosen, len(frames), rows, events, colors, evidence)
    (task.out / "index.html").write_text(page, encoding="utf-8", newline="\n")
    return StageResult({"n_images": len(chosen), "n_frames": len(frames)})


def _write_frames(
    task: StageTask, chosen: list[FrameBoxes], colors: dict[str, tuple[int, int, int]], evidence: list[Evidence]
) -> None:
    """Decode the video once, in order, and write the chosen frames with their boxes, and the evidence of defects."""
    wanted = {frame.source_index: frame for frame in chosen}
    source = {row["index"]: row["source_index"] for row in read_json(task.input("frames") / "frames.json")}
    shown: dict[int, list[Evidence]] = {}
    for one in evidence:
        shown.setdefault(source[one.frame_index], []).append(one)
    if not wanted and not shown:
        return
    last = max([*wanted, *shown])
    with VideoReader(task.video, max_pixels=task.max_frame_pixels) as reader:
        for decoded in reader.frames():
            frame = wanted.get(decoded.index)
            quality = [cv2.IMWRITE_JPEG_QUALITY, task.settings.gallery.jpeg_quality]
            if frame is not None:
                _write_image(task, frame.file_name, draw_boxes(decoded.rgb(), frame.rows, colors), quality)
            for one in shown.get(decoded.index, ()):
                _write_image(task, one.file_name, draw_evidence(decoded.rgb(), one), quality)
            task.report(0.5 * decoded.index, last + 1, f"frame {decoded.index} of {last}")
            if decoded.index >= last:
                break


def _write_views(task: StageTask) -> None:
    """Render the surface from two sides from which its defects are seen."""
    mesh = read_mesh(task.input("timeline") / "mesh_defects.ply")
    with np.load(task.input("timeline") / "cameras.npz") as cameras:
        poses = cameras["cam_from_world"]
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
