"""Stage `probe`: every video decoded once; its facts and its frame table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from core.flags import Flag, Severity
from core.products.front import ProbeProduct, VideoLength
from core.stage import StageTask
from core.video.probe import probe_video
from core.video.table import RATE_FROM, FrameTable, VideoInfo, colon_text, listed, rational_text
from core.videos import folder_of_video, named, naming_video, require_one_size


def run(task: StageTask) -> ProbeProduct:
    """Write `video.json` and `table.csv` of every video; `BadInput` when one cannot be used, or their sizes differ."""
    infos: list[VideoInfo] = []
    for video in range(len(task.recordings)):
        with naming_video(video, len(task.recordings)):
            table = _probe(task, video)
        folder = folder_of_video(task.out, video)
        folder.mkdir(exist_ok=True)
        table.write(folder)
        infos.append(table.info)
        require_one_size([(info.width, info.height) for info in infos])
    return _product(infos)


def _probe(task: StageTask, video: int) -> FrameTable:
    total, settings = len(task.recordings), task.settings.input

    def on_frame(done: int, declared: int) -> None:
        share = done / max(done, declared)
        task.report(video + share, total, named(f"frame {done}", video, total))

    return probe_video(
        task.recordings[video].video,
        allow_truncated=settings.allow_truncated,
        stream=settings.video_stream,
        fps=settings.fps,
        max_pixels=task.max_frame_pixels,
        on_frame=on_frame,
    )


def _product(infos: Sequence[VideoInfo]) -> ProbeProduct:
    """Of all videos together, and of each where there are several."""
    total, first = len(infos), infos[0]
    videos = tuple(VideoLength(n_frames=info.n_frames, duration_s=info.duration_s) for info in infos)
    return ProbeProduct(
        n_frames=sum(info.n_frames for info in infos),
        width=first.width,
        height=first.height,
        average_rate=rational_text(first.average_rate),
        duration_s=sum(info.duration_s for info in infos),
        truncated=any(info.truncated for info in infos),
        flags=tuple(
            replace(flag, where=named(flag.where, video, total))
            for video, info in enumerate(infos)
            for flag in flags_of(info)
        ),
        videos=videos if total > 1 else None,
    )


def flags_of(info: VideoInfo) -> list[Flag]:
    """What a reader of the result must know of its video."""
    flags = []
    if info.truncated:
        flags.append(Flag("truncated_video", Severity.WARNING, where="; ".join(info.damage)))
    if info.repaired_times:
        flags.append(Flag("times_repaired", Severity.WARNING, float(info.repaired_times), 0.0, "frames"))
    if info.joined:
        where = f"frame {', '.join(map(str, info.joined))}"
        flags.append(Flag("recording_joined", Severity.INFO, float(len(info.joined)), 0.0, where))
    if info.streams:
        where = f"stream {info.stream} of: {'; '.join(info.streams)}"
        flags.append(Flag("video_stream_chosen", Severity.INFO, float(len(info.streams)), 1.0, where))
    if info.damaged_pictures:
        where = f"frame {listed(info.damaged_pictures)}"
        flags.append(Flag("damaged_pictures", Severity.WARNING, float(len(info.damaged_pictures)), 0.0, where))
    if info.times_from != "file":
        severity = Severity.WARNING if info.times_from == "assumed" else Severity.INFO
        where = f"{float(info.average_rate):g} frames/s, {RATE_FROM[info.times_from]}"
        flags.append(Flag("times_made_up", severity, where=where))
    if info.interlaced_frames:
        where = f"{info.interlaced_frames} of {info.n_frames} frames"
        flags.append(Flag("interlaced", Severity.INFO, float(info.interlaced_frames), 0.0, where))
    if info.sample_aspect_ratio != 1:
        where = f"sample aspect ratio {colon_text(info.sample_aspect_ratio)}, pictures {info.width}x{info.height}"
        flags.append(Flag("pixels_not_square", Severity.INFO, float(info.sample_aspect_ratio), 1.0, where))
    return flags
