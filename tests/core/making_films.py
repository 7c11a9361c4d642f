"""Videos made and described by Debian's ffmpeg and ffprobe: an opinion that does not come from this project."""

from __future__ import annotations

import json
import subprocess
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from numpy.typing import NDArray

SAMPLE = Path(__file__).parents[2] / "samples" / "turbine.mp4"
_LOSSLESS = ("-c:v", "ffv1")
SMALL = ("-vf", "scale=160:120", "-frames:v", "48")


def ffmpeg(target: Path, *words: str | Path) -> Path:
    """Run ffmpeg with `target` as its output."""
    subprocess.run(["ffmpeg", "-v", "error", "-y", *map(str, words), str(target)], check=True, capture_output=True)
    return target


def film(target: Path, *words: str) -> Path:
    """48 small frames of the sample, 12 frames/s; each kind is encoded once."""
    target.write_bytes(_encoded(target.suffix, words))
    return target


@cache
def _encoded(suffix: str, words: tuple[str, ...]) -> bytes:
    with TemporaryDirectory() as folder:
        if words == _LOSSLESS:
            return ffmpeg(Path(folder) / "small.mkv", "-i", SAMPLE, *SMALL, *words).read_bytes()
        small = film(Path(folder) / "small.mkv", *_LOSSLESS)
        return ffmpeg(Path(folder) / f"film{suffix}", "-i", small, *words).read_bytes()


@dataclass(frozen=True)
class Listed:
    """What ffprobe lists of one stream."""

    pts: list[int]
    """Presentation times in units of the stream; best effort where the file holds none."""
    index: int
    times: list[str]
    """The same in seconds, as ffprobe prints them."""


def ffprobe_frames(path: Path, stream: str = "v:0") -> Listed:
    """ffprobe's frame list of a stream."""
    words = ["ffprobe", "-v", "error", "-select_streams", stream, "-of", "json"]
    entries = "frame=pts,best_effort_timestamp,pts_time,best_effort_timestamp_time:stream=index"
    words += ["-show_entries", entries, str(path)]
    said = json.loads(subprocess.run(words, check=True, capture_output=True, text=True).stdout)
    frames = [int(frame.get("pts", frame.get("best_effort_timestamp"))) for frame in said["frames"]]
    times = [str(frame.get("pts_time", frame.get("best_effort_timestamp_time"))) for frame in said["frames"]]
    return Listed(frames, int(said["streams"][0]["index"]), times)


def ffmpeg_pixels(path: Path, stream: str, width: int, height: int, filters: str = "") -> NDArray[np.uint8]:
    """(n, h, w, 3) RGB of every frame of a stream as ffmpeg decodes it and its `filters` make it."""
    words = ["ffmpeg", "-v", "error", "-i", str(path), "-map", f"0:{stream}", "-fps_mode", "passthrough"]
    words += ["-vf", filters] if filters else []
    words += ["-f", "rawvideo", "-pix_fmt", "rgb24", "-"]
    data = subprocess.run(words, check=True, capture_output=True).stdout
    return np.frombuffer(data, np.uint8).reshape(-1, height, width, 3)
