"""Videos that are made of single pictures: in a folder, by a pattern, in a zip."""

from __future__ import annotations

import hashlib
import shutil
import subprocess
import zipfile
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from core.errors import BadInput
from core.video import pictures as module
from core.video.factory import open_video
from core.video.formats import PICTURE_CODECS
from core.video.pictures import digest_of_video, find_pictures, natural_key
from core.video.probe import probe_video
from tests.core.making_films import ffmpeg
from tests.core.making_videos import every_ms, make_video, picture

COUNT = 12


def folder_of(target: Path, suffix: str = "png", count: int = COUNT, name: str = "f{}") -> Path:
    """Pictures 1 ... `count`, whose numbers have as many digits as they need."""
    target.mkdir(parents=True)
    for number in range(1, count + 1):
        Image.fromarray(picture(number)).save(target / f"{name.format(number)}.{suffix}")
    return target


def zip_of(folder: Path, target: Path, inside: str = "") -> Path:
    with zipfile.ZipFile(target, "w") as packed:
        for path in sorted(folder.iterdir()):
            packed.write(path, f"{inside}{path.name}")
    return target


def frames_of(path: Path, fps: float = 10) -> list[np.ndarray]:
    with open_video(path, fps=fps) as reader:
        return [frame.rgb() for frame in reader.frames()]


@pytest.mark.parametrize("suffix", PICTURE_CODECS)
def test_a_folder_is_a_video_in_the_order_of_its_numbers(suffix: str, tmp_path: Path) -> None:
    folder = folder_of(tmp_path / "frames", suffix)
    (folder / "notes.txt").write_text("no picture")
    (folder / f".f99.{suffix}").write_bytes(b"hidden")
    table = probe_video(folder, fps=12.5)
    info = table.info
    assert (info.width, info.height, info.n_frames, info.codec) == (160, 128, COUNT, PICTURE_CODECS[suffix])
    assert (info.average_rate, info.declared_rate, info.times_from) == (Fraction(25, 2), Fraction(25, 2), "given")
    assert [table.time(i) for i in range(COUNT)] == [Fraction(2 * i, 25) for i in range(COUNT)]
    assert info.duration_s == pytest.approx(COUNT / 12.5)
    assert (info.damage, info.damaged_pictures, info.repaired_times) == ((), (), 0)
    for number, rgb in enumerate(frames_of(folder), start=1):
        assert np.abs(rgb.astype(int) - picture(number)).mean() < (4 if suffix in ("jpg", "jpeg") else 0.01)


@pytest.mark.tool("ffmpeg")
def test_pictures_are_what_ffmpeg_decodes(tmp_path: Path) -> None:
    video = make_video(tmp_path / "a.mp4", every_ms(40, 5))
    (tmp_path / "p").mkdir()
    ffmpeg(tmp_path / "p" / "%04d.jpg", "-i", video, "-q:v", "2")
    words = [
        "ffmpeg",
        "-v",
        "error",
        "-i",
        str(tmp_path / "p" / "%04d.jpg"),
        "-f",
        "rawvideo",
        "-pix_fmt",
        "rgb24",
        "-",
    ]
    said = subprocess.run(words, capture_output=True, check=True).stdout
    theirs = np.frombuffer(said, np.uint8).reshape(-1, 128, 160, 3)
    ours = np.stack(frames_of(tmp_path / "p"))
    assert ours.shape == theirs.shape
    assert np.abs(ours.astype(int) - theirs.astype(int)).max() <= 3


def test_folder_pattern_and_zip_are_one_video(tmp_path: Path) -> None:
    folder = folder_of(tmp_path / "frames")
    (folder / "x1.png").write_bytes((folder / "f1.png").read_bytes())
    pattern = probe_video(folder / "f%d.png", fps=5)
    (folder / "x1.png").unlink()
    whole = probe_video(folder, fps=5)
    packed = probe_video(zip_of(folder, tmp_path / "a.zip", "inner/"), fps=5)
    assert whole.rows == pattern.rows == packed.rows
    assert whole.info.sha256 == pattern.info.sha256 == digest_of_video(folder)
    assert packed.info.sha256 == hashlib.sha256((tmp_path / "a.zip").read_bytes()).hexdigest()


def test_the_name_of_the_whole_is_what_sha256sum_says(tmp_path: Path) -> None:
    folder = folder_of(tmp_path / "frames", count=9)
    listed = subprocess.run(
        ["sha256sum", *sorted(p.name for p in folder.iterdir())], cwd=folder, capture_output=True, check=True
    )
    assert digest_of_video(folder) == hashlib.sha256(listed.stdout).hexdigest()
    before = digest_of_video(folder)
    shutil.move(folder / "f1.png", folder / "f90.png")
    assert digest_of_video(folder) != before, "the order is part of it"


def test_numbers_in_names_are_numbers() -> None:
    names = ["b2", "a10.png", "a9.png", "a09.png", "a1b10", "a1b9", "A1"]
    assert sorted(names, key=natural_key) == ["A1", "a1b9", "a1b10", "a09.png", "a9.png", "a10.png", "b2"]


def test_marks_that_ask_for_a_turn_are_ignored(tmp_path: Path) -> None:
    folder = tmp_path / "turned"
    folder.mkdir()
    for number in range(3):
        exif = Image.Exif()
        exif[0x0112] = 6
        Image.fromarray(picture(number)).save(folder / f"{number}.jpg", exif=exif, quality=95)
    table = probe_video(folder, fps=10)
    assert (table.info.width, table.info.height, table.info.rotation_deg) == (160, 128, 0)
    assert np.abs(frames_of(folder)[1].astype(int) - picture(1)).mean() < 4


@pytest.mark.parametrize("mode", ["L", "P", "RGBA", "I;16"])
def test_every_kind_of_picture_becomes_rgb(mode: str, tmp_path: Path) -> None:
    folder = tmp_path / "p"
    folder.mkdir()
    for number in range(2):
        grey = picture(number)[..., 0]
        image = Image.fromarray(grey.astype(np.uint16) * 257) if mode == "I;16" else Image.fromarray(grey).convert(mode)
        image.save(folder / f"{number}.png")
    for number, rgb in enumerate(frames_of(folder)):
        assert rgb.dtype == np.uint8
        assert np.abs(rgb.astype(int) - picture(number)[..., :1]).max() <= 1


def test_a_picture_of_another_size_is_named(tmp_path: Path) -> None:
    folder = folder_of(tmp_path / "frames")
    Image.fromarray(picture(3, 160, 120)).save(folder / "f7.png")
    with pytest.raises(
        BadInput, match=r"picture 'f7\.png' of 'frames' is 160x120, those before it are 160x128"
    ) as caught:
        probe_video(folder, fps=10)
    assert caught.value.code == "frame_size_changes"


def test_a_picture_that_does_not_decode_is_damage_and_keeps_its_time(tmp_path: Path) -> None:
    folder = folder_of(tmp_path / "frames")
    (folder / "f4.png").write_bytes(b"nothing")
    with pytest.raises(BadInput, match=r"the picture 'f4\.png' does not decode; 11 frames decode") as caught:
        probe_video(folder, fps=10)
    assert caught.value.code == "truncated_video"
    part = probe_video(folder, fps=10, allow_truncated=True)
    assert [row.pts for row in part.rows] == [0, 1, 2, *range(4, COUNT)]


def test_a_picture_that_ends_early_is_named_and_stays(tmp_path: Path) -> None:
    folder = folder_of(tmp_path / "frames", "jpg")
    data = (folder / "f4.jpg").read_bytes()
    (folder / "f4.jpg").write_bytes(data[: len(data) // 2])
    table = probe_video(folder, fps=10)
    assert (table.info.damaged_pictures, table.info.damage, table.info.n_frames) == ((3,), (), COUNT)


@pytest.mark.parametrize(
    ("make", "code", "part"),
    [
        (lambda t: t, "not_a_file", "directory without pictures"),
        (lambda t: t / "%04d.png", "missing_file", r"no file has a name like '%04d\.png'"),
        (lambda t: folder_of(t / "a") / "f%d.txt", "missing_file", "no file has a name like"),
        (lambda t: zip_of(folder_of(t / "a", "gif"), t / "a.zip"), "no_pictures", "'a.zip' holds no pictures"),
        (lambda t: cut(zip_of(folder_of(t / "a"), t / "a.zip")), "unreadable_file", "zip 'a.zip' is damaged"),
        (lambda t: two_folders(t), "pictures_unclear", "several folders"),
        (lambda t: folder_of(t / "a", count=1), "single_frame", "only one frame"),
    ],
)
def test_what_is_no_video_is_one_clear_error(
    make: Callable[[Path], Path], code: str, part: str, tmp_path: Path
) -> None:
    with pytest.raises(BadInput, match=part) as caught:
        probe_video(make(tmp_path), fps=10)
    assert caught.value.code == code


def cut(path: Path) -> Path:
    path.write_bytes(path.read_bytes()[:-40])
    return path


def two_folders(target: Path) -> Path:
    folder = folder_of(target / "a", count=2)
    with zipfile.ZipFile(target / "two.zip", "w") as packed:
        packed.write(folder / "f1.png", "left/f1.png")
        packed.write(folder / "f2.png", "right/f2.png")
    return target / "two.zip"


def test_times_have_to_be_told(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=r"say how many there are per second \(--fps N, input\.fps\)") as caught:
        probe_video(folder_of(tmp_path / "a"))
    assert caught.value.code == "fps_missing"


def test_pictures_have_no_streams(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="consists of pictures and has no video stream 0") as caught:
        probe_video(folder_of(tmp_path / "a"), fps=10, stream=0)
    assert caught.value.code == "no_such_stream"


def test_packers_folders_are_not_seen(tmp_path: Path) -> None:
    packed = zip_of(folder_of(tmp_path / "a"), tmp_path / "a.zip")
    with zipfile.ZipFile(packed, "a") as more:
        more.writestr("__MACOSX/._f1.png", b"resource")
        more.writestr("__MACOSX/x.png", b"resource")
    assert probe_video(packed, fps=10).info.n_frames == COUNT


def test_a_zip_that_unpacks_to_more_than_a_picture_may_have_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(module, "MAX_PICTURE_BYTES", 1 << 20)
    with zipfile.ZipFile(tmp_path / "bomb.zip", "w", zipfile.ZIP_DEFLATED) as packed:
        packed.writestr("1.png", bytes(8 << 20))
    assert (tmp_path / "bomb.zip").stat().st_size < 20_000
    with pytest.raises(BadInput, match=r"the picture '1\.png' has more than 1 MiB") as caught:
        probe_video(tmp_path / "bomb.zip", fps=10)
    assert caught.value.code == "too_large"


def test_more_pictures_than_are_read_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MAX_PICTURES", COUNT - 1)
    with pytest.raises(BadInput, match="holds 12 pictures; at most 11 are read") as caught:
        find_pictures(folder_of(tmp_path / "a"))
    assert caught.value.code == "too_many_frames"


def test_large_pictures_are_refused_from_their_header(tmp_path: Path) -> None:
    folder = tmp_path / "large"
    folder.mkdir()
    for number in range(2):
        cv2.imwrite(str(folder / f"{number}.png"), np.zeros((3000, 3000), np.uint8))
    with pytest.raises(BadInput, match=r"'0\.png' have 3000x3000") as caught:
        probe_video(folder, fps=10, max_pixels=8_000_000)
    assert caught.value.code == "too_many_pixels"


def test_a_name_that_no_file_can_have_is_one_clear_error(tmp_path: Path) -> None:
    for name in ("x" * 300, "x" * 300 + "%04d.png"):
        with pytest.raises(BadInput, match="name cannot be used: File name too long"):
            probe_video(tmp_path / name, fps=10)
    with zipfile.ZipFile(tmp_path / "long.zip", "w") as packed:
        packed.writestr("9" * 5000 + ".png", b"")
    with pytest.raises(BadInput, match="a name of more than 255 bytes"):
        probe_video(tmp_path / "long.zip", fps=10)


def test_a_file_with_another_kind_of_content_is_no_zip(tmp_path: Path) -> None:
    assert find_pictures(make_video(tmp_path / "a.mp4", every_ms(40, 3))) is None
    assert find_pictures(tmp_path / "missing.mp4") is None
