"""Stage `pictures`: clean pictures of the frames, for the page."""

from __future__ import annotations

from collections.abc import Iterator

from core.io.annotations import read_detections
from core.io.frames import read_damaged, read_frames
from core.products.front import PicturesProduct
from core.scene.frame import RunFrames, SourceFrame
from core.stage import StageTask
from core.video.factory import reopen_video
from core.video.shown import shown_frames
from core.video.table import read_infos
from core.videos import named
from core.viewer.pictures import U8, drawn_detections, write_pictures


def run(task: StageTask) -> PicturesProduct:
    """Write `frames/`, `full/`, `sprite.jpg` and `pictures.json`."""
    folder = task.input("frames")
    frames = read_frames(folder)
    detections = drawn_detections(read_detections(task.input("annotations")), frames)
    made = write_pictures(task.out, _decoded(task, frames), detections, read_damaged(folder))
    return PicturesProduct(n_pictures=len(made.scales))


def _decoded(task: StageTask, frames: RunFrames) -> Iterator[tuple[int, U8]]:
    """(index, (h, w, 3) RGB) of every frame of the run; each video is decoded once, up to its last frame."""
    total = len(task.recordings)
    for video, info in enumerate(read_infos(task.input("probe"))):
        last = max((frame.source_index for frame in frames if frame.video == video), default=-1)
        if last < 0:
            continue
        with reopen_video(task.recordings[video].video, info, max_pixels=task.max_frame_pixels) as reader:
            for shown in shown_frames(reader.frames(), info):
                at = shown.decoded.index
                index = frames.index_of_source.get(SourceFrame(video, at))
                if index is not None:
                    yield index, shown.rgb()
                task.report(video + at / (last + 1), total, named(f"frame {at} of {last}", video, total))
                if at >= last:
                    break
