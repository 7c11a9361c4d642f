"""Stage `probe`: the video decoded once; its facts and its frame table."""

from __future__ import annotations

from core.flags import Flag, Severity
from core.stage import StageResult, StageTask
from core.video.probe import probe_video
from core.video.table import RATE_FROM, VideoInfo, colon_text, listed, rational_text


def run(task: StageTask) -> StageResult:
    """Write `video.json` and `table.csv`; `BadInput` when the video cannot be used."""

    def on_frame(done: int, declared: int) -> None:
        task.report(done, max(done, declared), f"frame {done}")

    settings = task.settings.input
    table = probe_video(
        task.video,
        allow_truncated=settings.allow_truncated,
        stream=settings.video_stream,
        fps=settings.fps,
        max_pixels=task.max_frame_pixels,
        on_frame=on_frame,
    )
    table.write(task.out)
    info = table.info
    return StageResult(
        {
            "n_frames": info.n_frames,
            "width": info.width,
            "height": info.height,
            "average_rate": rational_text(info.average_rate),
            "duration_s": info.duration_s,
            "truncated": info.truncated,
            "flags": [flag.to_dict() for flag in flags_of(info)],
        }
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
