"""Stage `probe`: the video decoded once; its facts and its frame table."""

from __future__ import annotations

from core.flags import Flag, Severity
from core.stage import StageResult, StageTask
from core.video.probe import probe_video
from core.video.table import rational_text


def run(task: StageTask) -> StageResult:
    """Write `video.json` and `table.csv`; `BadInput` when the video cannot be used."""

    def on_frame(done: int, declared: int) -> None:
        task.report(done, max(done, declared), f"frame {done}")

    settings = task.settings.input
    table = probe_video(
        task.video,
        allow_truncated=settings.allow_truncated,
        stream=settings.video_stream,
        max_pixels=task.max_frame_pixels,
        on_frame=on_frame,
    )
    table.write(task.out)
    info = table.info
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
    return StageResult(
        {
            "n_frames": info.n_frames,
            "width": info.width,
            "height": info.height,
            "average_rate": rational_text(info.average_rate),
            "duration_s": info.duration_s,
            "truncated": info.truncated,
            "flags": [flag.to_dict() for flag in flags],
        }
    )
