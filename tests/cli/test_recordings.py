"""Which of the files on a command line are videos, and whose annotations are whose."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from cli.arguments import parser
from cli.recordings import as_files, paired, recordings_of
from core.errors import BadInput
from core.video.pictures import find_pictures
from core.videos import MAX_VIDEOS, Recording
from tests.core.making_videos import every_ms, make_video

A, B, NOTES, OTHERS = Path("a.mp4"), Path("b.mp4"), Path("a.json"), Path("b.json")


def test_a_single_video_may_be_followed_by_its_annotations() -> None:
    assert paired([A], None) == [Recording(A)]
    assert paired([A, NOTES], None) == [Recording(A, NOTES)]
    assert paired([A], [NOTES]) == [Recording(A, NOTES)]


def test_two_videos_are_told_by_the_content_of_the_second(tmp_path: Path) -> None:
    second = make_video(tmp_path / "without suffix.avi", every_ms(40, 4))
    assert paired([A, second], None) == [Recording(A), Recording(second)]
    assert paired([A, B, OTHERS], None) == [Recording(A), Recording(B), Recording(OTHERS)]


def test_annotations_are_in_the_order_of_the_videos() -> None:
    assert paired([A, B], [NOTES, OTHERS]) == [Recording(A, NOTES), Recording(B, OTHERS)]
    assert paired([A, B], [Path("-"), OTHERS]) == [Recording(A), Recording(B, OTHERS)]


@pytest.mark.parametrize("notes", [[NOTES], [NOTES, OTHERS, NOTES]])
def test_every_video_has_its_annotations_or_none_has(notes: list[Path]) -> None:
    with pytest.raises(BadInput, match=f"^{len(notes)} annotation file.* for 2 videos") as caught:
        paired([A, B], notes)
    assert caught.value.where == "--annotations"


def test_there_is_a_limit() -> None:
    with pytest.raises(BadInput, match=f"1 to {MAX_VIDEOS}"):
        paired([A] * (MAX_VIDEOS + 1), None)


@pytest.mark.parametrize("command", [["run", "--out", "x"], ["submit"]])
def test_commands_take_them(command: list[str], tmp_path: Path) -> None:
    folder = tmp_path / "labels"
    folder.mkdir()
    (folder / "one.json").write_text("{}")
    parsed = parser().parse_args([*command, "a.mp4", "b.mp4", "--annotations", "-", str(folder)])
    with recordings_of(parsed) as recordings:
        first, second = recordings
        assert (first, second.video) == (Recording(A), B)
        assert second.annotations is not None
        assert second.annotations.read_bytes().startswith(b"PK"), "a folder is packed"
        packed = second.annotations
    assert not packed.exists()


def test_pictures_are_packed_for_a_server_and_stay_the_same_video(tmp_path: Path) -> None:
    film = make_video(tmp_path / "film.mp4", every_ms(40, 4))
    folder = tmp_path / "frames"
    folder.mkdir()
    for number in (1, 2, 10):
        cv2.imwrite(str(folder / f"{number}.png"), np.full((48, 64, 3), 20 * number, np.uint8))
    (folder / "notes.txt").write_text("no picture")
    with as_files([Recording(film), Recording(folder, NOTES), Recording(folder / "%d.png")]) as sent:
        assert sent[0] == Recording(film)
        assert (sent[1].annotations, sent[1].video.name) == (NOTES, "frames.zip")
        assert sent[1].video.read_bytes() == sent[2].video.read_bytes()
        with find_pictures(sent[1].video) or pytest.fail("the zip holds no pictures") as zipped:
            assert zipped.names == ("1.png", "2.png", "10.png")
            assert [zipped.read(name) for name in zipped.names] == [
                (folder / name).read_bytes() for name in zipped.names
            ]
        packed = sent[1].video
    assert not packed.exists()


def test_a_folder_without_pictures_is_named_before_anything_is_sent(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    with pytest.raises(BadInput, match=r"'empty'.*without pictures"), as_files([Recording(tmp_path / "empty")]):
        pass
