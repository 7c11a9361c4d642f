"""`bladeatlas-bench inputs`: what it costs to look at a long video before anything is made of it.

The video is a few seconds of moving texture, encoded once and joined with itself packet by packet, so that an hour of
it is there in seconds. `bladeatlas probe` reads it as a process of its own, whose largest resident memory is the
figure.
"""

from __future__ import annotations

import argparse
import json
import subprocess
import sys
import time
from fractions import Fraction
from pathlib import Path

import av
import numpy as np
import psutil

from bench.speed.timing import Row, Table
from core.errors import BadInput, StageFailed

RATE = 25
"""Frames per second."""
PIECE_S = 8
"""Seconds that are encoded."""
LIMIT_MB = 150.0
"""Largest resident memory of a probe that is asked for."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of `inputs`."""
    parser.add_argument("out", type=Path, metavar="OUT", help="folder for the video; one that is there is used again")
    parser.add_argument("--minutes", type=float, default=60.0, metavar="N", help="length of the video (60)")
    parser.add_argument("--size", default="1920x1080", metavar="WxH", help="size of its frames (1920x1080)")
    parser.add_argument("--json", action="store_true", help="print JSON instead of a table")


def command(arguments: argparse.Namespace) -> None:
    """Make the video, probe it, print time and memory."""
    width, _, height = arguments.size.partition("x")
    if not (width.isdecimal() and height.isdecimal()) or arguments.minutes <= 0:
        raise BadInput("--size is WIDTHxHEIGHT and --minutes above 0", where="--size")
    arguments.out.mkdir(parents=True, exist_ok=True)
    video = arguments.out / f"{arguments.size}-{arguments.minutes:g}min.mp4"
    if not video.exists():
        make_long_video(video, int(width), int(height), 60 * arguments.minutes)
    table = probe_costs(video)
    print(json.dumps([row.to_dict() for row in table.rows], indent=1) if arguments.json else table.text())


def make_long_video(path: Path, width: int, height: int, seconds: float) -> None:
    """Encode `PIECE_S` seconds of moving texture and join them with themselves until they last `seconds`."""
    piece, whole = path.with_suffix(".piece.mp4"), path.with_suffix(".part.mp4")
    _encode(piece, width, height)
    with av.open(str(piece)) as source, av.open(str(whole), "w") as target:
        video = source.streams.video[0]
        joined = target.add_stream_from_template(video)
        packets = [packet for packet in source.demux(video) if packet.dts is not None]
        assert video.time_base is not None
        length = int(Fraction(PIECE_S) / video.time_base)
        stamps = [(packet.pts, packet.dts) for packet in packets]
        for turn in range(max(1, round(seconds / PIECE_S))):
            for packet, (pts, dts) in zip(packets, stamps, strict=True):
                packet.stream = joined
                packet.time_base = video.time_base
                packet.pts = None if pts is None else pts + turn * length
                packet.dts = None if dts is None else dts + turn * length
                target.mux(packet)
    piece.unlink()
    whole.rename(path)


def _encode(path: Path, width: int, height: int) -> None:
    """Noise that is shifted from frame to frame: it costs a decoder about what a real picture does."""
    texture = np.random.default_rng(0).integers(0, 256, (height // 8, width // 8, 3), np.uint8)
    with av.open(str(path), "w") as container:
        stream = container.add_stream("libx264", rate=RATE, options={"crf": "28", "preset": "veryfast", "bf": "0"})
        stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
        for number in range(RATE * PIECE_S):
            moved = np.roll(np.kron(texture, np.ones((8, 8, 1), np.uint8)), 3 * number, axis=1)
            frame = np.zeros((height, width, 3), np.uint8)
            frame[: moved.shape[0], : moved.shape[1]] = moved
            container.mux(stream.encode(av.VideoFrame.from_ndarray(frame, format="rgb24")))
        container.mux(stream.encode(None))


def probe_costs(video: Path) -> Table:
    """Time and memory of `bladeatlas probe` on a video, as a table.

    Raises:
        StageFailed: the probe ended with an error.
    """
    started, peak_mb, cpu_s = time.monotonic(), 0.0, 0.0
    command = [sys.executable, "-m", "cli.main", "probe", str(video), "--json"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as child:
        # A process that has ended tells its memory no more, and what the kernel keeps of it counts its parent's too.
        process = psutil.Process(child.pid)
        while child.poll() is None:
            try:
                peak_mb = max(peak_mb, _peak_mb(child.pid))
                cpu_s = sum(process.cpu_times()[:2])
            except (psutil.Error, OSError):
                break
            time.sleep(0.1)
        said = child.communicate()[0]
    if child.returncode != 0:
        raise StageFailed(f"bladeatlas probe ended with code {child.returncode}", where="inputs")
    info = json.loads(said)
    title = f"bladeatlas probe on {info['n_frames']:,} frames of {info['width']}x{info['height']}"
    rows = (
        Row("largest resident memory", round(peak_mb, 1), "MB", f"< {LIMIT_MB:g}"),
        Row("time", round(time.monotonic() - started, 1), "s"),
        Row("processor time", round(cpu_s, 1), "s"),
        Row("frames per second", round(info["n_frames"] / max(cpu_s, 1e-9)), "1/s of processor time"),
    )
    return Table("inputs", title, rows)


def _peak_mb(pid: int) -> float:
    """Largest resident memory of a process so far, MB."""
    for line in Path(f"/proc/{pid}/status").read_text(encoding="ascii").splitlines():
        if line.startswith("VmHWM:"):
            return int(line.split()[1]) / 1000
    return 0.0
