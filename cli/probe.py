"""`bladeatlas probe`: what a video is.

It loads no more than it takes to decode one, so that its memory is small beside that of any video.
"""

from __future__ import annotations

import argparse
from itertools import pairwise

from cli.terminal import duration, say, say_json
from core.settings import make_settings
from core.video.probe import probe_video
from core.video.table import RATE_FROM, FrameTable, VideoInfo, colon_text, listed


def probe(parsed: argparse.Namespace) -> int:
    """Decode the whole video once and say what it holds; a damaged video is described, not refused."""
    fps = make_settings("default", {"input.fps": parsed.fps}).input.fps
    found = []
    for video in parsed.videos:
        table = probe_video(video, allow_truncated=True, stream=parsed.stream, fps=fps)
        found.append({**table.info.to_dict(), **_gaps(table)})
        if not parsed.json:
            _say_video(video.name, table)
    if parsed.json:
        say_json({"schema_version": 1, **(found[0] if len(found) == 1 else {"videos": found})}, indent=1)
    return 0


def _say_video(name: str, table: FrameTable) -> None:
    info, gaps = table.info, _gaps(table)
    steps = f"{gaps['min_step_s']:.4f} to {gaps['max_step_s']:.4f} s"
    say(
        f"{name}: {info.width}x{info.height}, {info.codec}, {info.n_frames} frames",
        f"  duration {duration(info.duration_s)}, {float(info.average_rate):.4g} frames/s on average",
        f"  time between frames {steps}, {'variable' if gaps['variable_rate'] else 'constant'} rate",
        *(f"  {note}" for note in notes(info)),
    )


def notes(info: VideoInfo) -> list[str]:
    """What somebody should know of a video before using it; empty for an ordinary sound one."""
    found = []
    if info.rotation_deg:
        found.append(f"rotated by {info.rotation_deg} degrees; size and boxes are of the frame as shown")
    if info.streams:
        streams = "; ".join(info.streams)
        found.append(f"stream {info.stream} was read of {streams} (--set input.video_stream=N for another)")
    if info.sample_aspect_ratio != 1:
        share = colon_text(info.sample_aspect_ratio)
        found.append(f"pixels are not square ({share}); frames are resampled, size and boxes are of square pixels")
    if info.interlaced_frames:
        frames = f"{info.interlaced_frames} of {info.n_frames} frames"
        found.append(f"interlaced: {frames}; they are deinterlaced, one picture per frame")
    if info.times_from != "file":
        rate = f"{float(info.average_rate):g} frames/s, {RATE_FROM[info.times_from]}"
        found.append(f"the file holds no times; they are made from {rate}")
    if info.joined:
        found.append(f"joined from {len(info.joined) + 1} recordings, at frame {', '.join(map(str, info.joined))}")
    if info.repaired_times:
        found.append(f"{info.repaired_times} frames have no usable time in the file; it is made from the frame rate")
    if info.damaged_pictures:
        found.append(f"damaged pictures: frame {listed(info.damaged_pictures)}; they give no keypoints")
    if info.truncated:
        found.append(f"damaged: {'; '.join(info.damage)} (a run needs --allow-truncated)")
    return found


def _gaps(table: FrameTable) -> dict[str, float | bool]:
    times = [row.time_s for row in table.rows]
    steps = [later - earlier for earlier, later in pairwise(times)]
    shortest, longest = min(steps), max(steps)
    return {"min_step_s": shortest, "max_step_s": longest, "variable_rate": longest > 1.5 * shortest}
