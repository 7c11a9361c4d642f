"""Several videos of one run: one axis of time, one size of frames, and the number of each where it matters."""

from __future__ import annotations

from pathlib import Path

import pytest

from core.errors import BadInput, StageFailed
from core.scene.frame import Frame, Role, RunFrames, SourceFrame
from core.videos import (
    MAX_VIDEOS,
    Recording,
    count_videos,
    folder_of_video,
    moment,
    named,
    naming_video,
    require_count,
    require_one_size,
    video_of,
)


def test_the_time_of_the_first_video_is_its_own_and_others_are_far_from_it() -> None:
    assert moment(0, 3599.25) == 3599.25
    assert moment(1, 0.0) - moment(0, 86_400.0) > 86_400.0
    assert [video_of(moment(number, 0.5)) for number in range(3)] == [0, 1, 2]
    assert video_of(-0.01) == 0


def test_frames_of_two_videos_with_one_number_are_two_frames() -> None:
    rows = [Frame(0, 7, 7, 0.7, "", Role.BOTH), Frame(1, 7, 7, 0.7, "", Role.BOTH, video=1)]
    frames = RunFrames(tuple(rows))
    assert frames.index_of_source == {SourceFrame(0, 7): 0, SourceFrame(1, 7): 1}
    assert frames.moments_s == [0.7, moment(1, 0.7)]
    assert frames.videos == [0, 1]


def test_folders_of_further_videos_are_counted(tmp_path: Path) -> None:
    assert count_videos(tmp_path) == 1
    for video in (1, 2, 4):
        folder_of_video(tmp_path, video).mkdir()
    assert folder_of_video(tmp_path, 0) == tmp_path
    assert count_videos(tmp_path) == 3, "2 is the last without a gap"


def test_an_error_names_its_video_where_there_are_several() -> None:
    with pytest.raises(BadInput, match=r"^video 1: it is broken$") as caught, naming_video(1, 2):
        raise BadInput("it is broken", code="broken", where="here")
    assert (caught.value.code, caught.value.where) == ("broken", "here")
    with pytest.raises(BadInput, match=r"^it is broken$"), naming_video(0, 1):
        raise BadInput("it is broken")
    with pytest.raises(StageFailed, match=r"^no fault of the input$"), naming_video(1, 2):
        raise StageFailed("no fault of the input")
    assert (named("", 1, 2), named("frame 3", 0, 1)) == ("video 1", "frame 3")


def test_videos_of_two_sizes_are_refused_and_both_named() -> None:
    require_one_size([(640, 480), (640, 480)])
    with pytest.raises(BadInput, match="video 0 has frames of 640x480, video 2 of 480x640") as caught:
        require_one_size([(640, 480), (640, 480), (480, 640)])
    assert caught.value.code == "video_sizes_differ"


@pytest.mark.parametrize("count", [0, MAX_VIDEOS + 1])
def test_as_many_videos_as_an_inspection_may_have(count: int) -> None:
    require_count(MAX_VIDEOS)
    with pytest.raises(BadInput, match=f"{count} videos"):
        require_count(count)


def test_a_recording_survives_json() -> None:
    for one in (Recording(Path("a.mp4"), Path("a.json")), Recording(Path("b.mp4"))):
        assert Recording.from_dict(one.to_dict()) == one
