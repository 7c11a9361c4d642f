"""Small videos for tests, made where they are used."""

from __future__ import annotations

import struct
import wave
from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import av
import numpy as np

MILLISECOND = Fraction(1, 1000)


def picture(number: int, width: int = 160, height: int = 128) -> np.ndarray:
    """A frame that tells its number: grey steps that move, a red upper left quarter."""
    x, y = np.meshgrid(np.arange(width), np.arange(height))
    image = np.stack([(x * 2 + number * 9) % 256, (y * 2) % 256, np.full_like(x, 60)], -1).astype(np.uint8)
    image[: height // 2, : width // 2] = (220, 10, 10)
    return image


def make_video(
    path: Path,
    times_ms: Sequence[int],
    *,
    size: tuple[int, int] = (160, 128),
    codec: str = "mpeg4",
    options: dict[str, str] | None = None,
    keyframe_every: int = 12,
) -> Path:
    """Encode one `picture` per time; the container comes from the suffix."""
    with av.open(str(path), "w", options=options or {}) as container:
        stream = container.add_stream(codec, rate=25)
        assert isinstance(stream, av.VideoStream)
        stream.width, stream.height = size
        stream.pix_fmt = "yuv420p"
        stream.codec_context.time_base = MILLISECOND
        stream.codec_context.gop_size = keyframe_every
        container.start_encoding()
        for number, time in enumerate(times_ms):
            frame = av.VideoFrame.from_ndarray(picture(number, *size), format="rgb24")
            frame.pts, frame.time_base = time, MILLISECOND
            container.mux(stream.encode(frame))
        container.mux(stream.encode(None))
    return path


def make_still_video(path: Path, source: Path, count: int, seed: int = 0) -> Path:
    """The first frame of `source` over and over, with a sensor's noise: a camera that does not move."""
    with av.open(str(source)) as container:
        still = next(container.decode(video=0)).to_ndarray(format="rgb24").astype(np.float64)
    rng = np.random.default_rng(seed)
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=12, options={"crf": "20"})
        stream.height, stream.width = still.shape[:2]
        stream.pix_fmt = "yuv420p"
        for _ in range(count):
            noisy = np.clip(still + rng.normal(0, 3, still.shape), 0, 255).astype(np.uint8)
            container.mux(stream.encode(av.VideoFrame.from_ndarray(noisy, format="rgb24")))
        container.mux(stream.encode(None))
    return path


def every_ms(step: int, count: int) -> list[int]:
    return [step * i for i in range(count)]


def set_display_matrix(path: Path, a: int, b: int, c: int, d: int) -> Path:
    """Write a, b, c, d into the display matrix of the first track of an MP4 file."""
    data = bytearray(path.read_bytes())
    header = data.index(b"tkhd") + 4
    matrix = header + 4 + (32 if data[header] == 1 else 20) + 16
    one = 1 << 16
    data[matrix : matrix + 36] = struct.pack(">9i", a * one, b * one, 0, c * one, d * one, 0, 0, 0, 1 << 30)
    path.write_bytes(data)
    return path


def make_wav(path: Path) -> Path:
    with wave.open(str(path), "wb") as stream:
        stream.setnchannels(1)
        stream.setsampwidth(2)
        stream.setframerate(8000)
        stream.writeframes(bytes(16000))
    return path


def cut_to(path: Path, share: float, target: Path) -> Path:
    """The first part of a file."""
    data = path.read_bytes()
    target.write_bytes(data[: int(len(data) * share)])
    return target
