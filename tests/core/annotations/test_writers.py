"""Keys as programs write them: each comes back to exactly the frame that the program had before it."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction
from math import floor
from pathlib import Path

import cv2
import numpy as np
import pytest

from core.annotations.checks import parse_time
from core.annotations.convention import Fitted, fit_convention
from core.video.decode import iter_frames
from core.video.probe import probe_video
from core.video.table import FrameTable
from tests.core.making_films import ffmpeg, ffprobe_frames
from tests.core.making_videos import every_ms, make_video
from tests.inputs import INPUTS

pytestmark = pytest.mark.slow

VARIABLE = [0, 33, 66, 99, 196, 229, 262, 295, 392, 500, 533, 566, 640, 673, 706, 739, 836, 869, 902, 1000]
DROPPED = [40 * i for i in range(40) if i % 7 != 3]


@dataclass(frozen=True)
class Film:
    """A video as this project and as OpenCV see it."""

    path: Path
    table: FrameTable
    fps: float
    """`CAP_PROP_FPS`."""
    msec: list[float]
    """`CAP_PROP_POS_MSEC` after each frame is read."""


def film_of(path: Path) -> Film:
    capture, msec = cv2.VideoCapture(str(path)), []
    while capture.read()[0]:
        msec.append(capture.get(cv2.CAP_PROP_POS_MSEC))
    return Film(path, probe_video(path), capture.get(cv2.CAP_PROP_FPS), msec)


@pytest.fixture(scope="module")
def films(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Film]:
    folder = tmp_path_factory.mktemp("films")
    return {
        "constant": film_of(make_video(folder / "constant.mp4", every_ms(40, 30))),
        "variable": film_of(make_video(folder / "variable.mp4", VARIABLE)),
        "milliseconds": film_of(make_video(folder / "variable.mkv", VARIABLE)),
        "gaps": film_of(make_video(folder / "gaps.mp4", DROPPED)),
        "empty chunks": film_of(INPUTS / "m96_drop15.avi"),
    }


FILMS = ["constant", "variable", "milliseconds", "gaps", "empty chunks"]


def cut(seconds: Fraction, decimals: int) -> str:
    return f"{floor(seconds * 10**decimals) / 10**decimals:.{decimals}f}"


WRITERS: dict[str, Callable[[Film, int], str]] = {
    "OpenCV, milliseconds": lambda film, i: str(film.msec[i]),
    "OpenCV, rounded milliseconds": lambda film, i: str(round(film.msec[i])),
    "OpenCV, milliseconds / 1000": lambda film, i: f"{film.msec[i] / 1000:.3f}",
    "OpenCV, frames before / rate": lambda film, i: f"{i / film.fps:.4f}",
    "OpenCV, frames read / rate": lambda film, i: f"{(i + 1) / film.fps:.4f}",
    "OpenCV, not rounded": lambda film, i: str(i / film.fps),
    "CVAT": lambda film, i: str(i),
    "numbers from 1": lambda film, i: str(i + 1),
    "Label Studio": lambda film, i: str((i + 1) / film.fps),
    "FFmpeg": lambda film, i: f"{float(film.table.rows[i].pts * film.table.info.time_base):.6f}",
    "player, 2 decimals": lambda film, i: cut(film.table.time(i), 2),
    "player, 3 decimals": lambda film, i: cut(film.table.time(i), 3),
    "player, clock": lambda film, i: f"00:00:{cut(film.table.time(i), 3):0>6}",
}
FROM_ONE = {"OpenCV, frames read / rate", "numbers from 1", "Label Studio"}


def fit(film: Film, keys: list[str]) -> Fitted:
    return fit_convention({key: parse_time(key) for key in keys}, film.table)


@pytest.mark.parametrize("writer", WRITERS)
@pytest.mark.parametrize("name", FILMS)
def test_a_key_for_every_frame(films: dict[str, Film], name: str, writer: str) -> None:
    film = films[name]
    fitted = fit(film, [WRITERS[writer](film, i) for i in range(len(film.msec))])
    assert list(fitted.reading.frames.values()) == list(range(len(film.msec)))
    assert fitted.flags == (), "a key for every frame leaves no doubt"


@pytest.mark.parametrize("writer", WRITERS)
@pytest.mark.parametrize("name", FILMS)
def test_a_key_for_some_frames(films: dict[str, Film], name: str, writer: str) -> None:
    film = films[name]
    frames = [2, 5, 6, 11, 14]
    fitted = fit(film, [WRITERS[writer](film, i) for i in frames])
    meant = [list(one.frames.values()) for one in (fitted.reading, *fitted.others)]
    assert frames in meant, "taken, or named as what else it can be"
    seconds_at_constant_rate = name == "constant" and "." in next(iter(fitted.reading.frames))
    if meant[0] != frames:
        assert writer in FROM_ONE or name == "empty chunks"
        assert [flag.severity for flag in fitted.flags] == ["info" if seconds_at_constant_rate else "warning"]
    if seconds_at_constant_rate:
        assert all(flag.severity == "info" for flag in fitted.flags), "ordinary files are not suspect"


def test_opencv_reads_the_frames_of_the_table(films: dict[str, Film]) -> None:
    for film in films.values():
        capture, step = cv2.VideoCapture(str(film.path)), 4
        theirs = [capture.read()[1][::step, ::step, ::-1].astype(np.int16) for _ in film.msec]
        ours = [rgb[::step, ::step].astype(np.int16) for _, _, _, rgb in iter_frames(film.path)]
        assert len(theirs) == len(ours) == film.table.info.n_frames
        for i, picture in enumerate(theirs):
            beside = range(max(0, i - 2), min(len(ours), i + 3))
            assert min(beside, key=lambda k: np.abs(ours[k] - picture).mean()) == i
        assert float(film.table.info.declared_rate or 0) == pytest.approx(film.fps)


def test_the_frames_that_a_recorder_dropped_have_no_number(films: dict[str, Film]) -> None:
    keys = json.loads((INPUTS / "cv_fps.json").read_text())
    fitted = fit(films["empty chunks"], list(keys))
    assert (fitted.reading.clock, fitted.flags) == ("declared_rate", ())
    assert list(fitted.reading.frames.values()) == list(range(90))
    by_pts = fit_convention({key: parse_time(key) for key in keys}, films["empty chunks"].table, "pts").reading
    assert sum(by_pts.frames[key] != i for i, key in enumerate(keys)) == 83, "what presentation times would make of it"


MAKES = {
    "constant.mp4": ["-r", "30000/1001"],
    "constant.mkv": ["-r", "30000/1001"],
    "constant.flv": ["-bf", "0", "-c:v", "flv"],
    "constant.ts": ["-c:v", "mpeg2video"],
    "dropped.mkv": ["-vf", "select=mod(n\\,5)", "-fps_mode", "vfr"],
    "dropped.mp4": ["-vf", "select=mod(n\\,5)", "-fps_mode", "vfr"],
    "dropped.ts": ["-vf", "select=mod(n\\,5)", "-fps_mode", "vfr", "-c:v", "mpeg2video"],
}


@pytest.mark.tool("ffmpeg")
@pytest.mark.parametrize("name", MAKES)
def test_ffprobe_lists_the_frames_of_the_table(tmp_path: Path, name: str) -> None:
    source = ["-f", "lavfi", "-i", "testsrc=size=128x96:rate=30:duration=1.5", "-bf", "2", "-c:v", "mpeg4"]
    path = tmp_path / name
    listed = ffprobe_frames(ffmpeg(path, *source, *MAKES[name])).times
    film = film_of(path)
    for keys in (listed, [f"{i / film.fps:.6f}" for i in range(len(film.msec))], [f"{m:.0f}" for m in film.msec]):
        fitted = fit(film, keys)
        assert list(fitted.reading.frames.values()) == list(range(len(listed)))
        assert fitted.flags == ()


@pytest.mark.tool("ffmpeg")
@pytest.mark.parametrize("name", ["m96.avi", "m96_drop15.avi"])
def test_empty_chunks_are_no_frames(name: str) -> None:
    table = probe_video(INPUTS / name)
    assert [f"{float(row.pts * table.info.time_base):.6f}" for row in table.rows] == ffprobe_frames(INPUTS / name).times


TIMELESS = [
    "OpenCV, frames before / rate",
    "OpenCV, frames read / rate",
    "OpenCV, not rounded",
    "CVAT",
    "numbers from 1",
]


@pytest.mark.parametrize("writer", [*TIMELESS, "Label Studio"])
def test_keys_of_a_raw_stream_by_the_rate_that_opencv_assumes(writer: str) -> None:
    """12 frames/s by the stream's own header; OpenCV says 25, and gives every frame the time 0."""
    film = film_of(INPUTS / "raw.h264")
    assert (film.fps, film.table.info.average_rate, set(film.msec)) == (25.0, Fraction(12), {0.0})
    fitted = fit(film, [WRITERS[writer](film, i) for i in range(48)])
    assert list(fitted.reading.frames.values()) == list(range(48))
    assert fitted.flags == ()


@pytest.mark.parametrize("writer", [name for name in WRITERS if name not in ("OpenCV, milliseconds", "FFmpeg")])
def test_keys_of_pictures_by_the_rate_that_was_told(writer: str, tmp_path: Path) -> None:
    for number in range(20):
        cv2.imwrite(str(tmp_path / f"{number}.png"), np.full((64, 64, 3), 12 * number, np.uint8))
    table = probe_video(tmp_path, fps=12.5)
    film = Film(tmp_path, table, 12.5, [80.0 * i for i in range(20)])
    fitted = fit(film, [WRITERS[writer](film, i) for i in range(20)])
    assert list(fitted.reading.frames.values()) == list(range(20))


@pytest.mark.tool("ffmpeg")
@pytest.mark.parametrize("writer", WRITERS)
@pytest.mark.parametrize("rate", ["5.6", "0.5"])
def test_keys_at_low_rates(writer: str, rate: str, tmp_path: Path) -> None:
    source = ["-f", "lavfi", "-i", f"testsrc=size=128x96:rate={rate}", "-frames:v", "12", "-c:v", "mpeg4"]
    film = film_of(ffmpeg(tmp_path / "slow.mp4", *source))
    fitted = fit(film, [WRITERS[writer](film, i) for i in range(12)])
    assert list(fitted.reading.frames.values()) == list(range(12))
