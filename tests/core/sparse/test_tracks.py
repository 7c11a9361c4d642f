from __future__ import annotations

import numpy as np
import pytest

from core.sparse.tracks import GRID, Tracks, build_tracks, choose_keypoints, thin_cache
from core.sparse.view_graph import Frames, within
from core.verification import camera_from_dict
from core.viewgraph import PairTable
from tests.core.sparse.scene import HEIGHT, LENS, WIDTH, Scene, make_scene, view_graph


def table(matches: dict[tuple[int, int], list[tuple[int, int]]]) -> PairTable:
    n = len(matches)
    counts = [len(rows) for rows in matches.values()]
    return PairTable(
        np.array(list(matches), np.int32).reshape(-1, 2),
        np.zeros(n, np.uint8),
        np.array(counts, np.int32),
        np.full(n, 2, np.uint8),
        np.cumsum([0, *counts]).astype(np.int64),
        np.array([row for rows in matches.values() for row in rows], np.uint32).reshape(-1, 2),
        np.tile([0.0, 0.0, 0.0, 1.0], (n, 1)),
        np.zeros((n, 3)),
        np.full(n, 5.0, np.float32),
    )


def listed(graph: PairTable) -> list[list[tuple[int, int]]]:
    tracks = build_tracks(graph)
    return [
        list(zip(tracks.frame[a:b].tolist(), tracks.keypoint[a:b].tolist(), strict=True))
        for a, b in zip(tracks.offsets[:-1], tracks.offsets[1:], strict=True)
    ]


def frames_of(scene: Scene) -> Frames:
    indices = tuple(range(len(scene.features)))
    keypoints = tuple(features.keypoints.astype(np.float64) for features in scene.features)
    return Frames(indices, tuple(f"{i:04d}.jpg" for i in indices), keypoints, camera_from_dict(LENS))


def test_matches_join_to_tracks_longest_first() -> None:
    graph = table({(0, 1): [(0, 4), (2, 2)], (1, 2): [(4, 7)]})
    assert listed(graph) == [[(0, 0), (1, 4), (2, 7)], [(0, 2), (1, 2)]]


def test_a_track_never_holds_two_keypoints_of_one_frame() -> None:
    # Frame 2 closes the loop at another keypoint of frame 0: the far match loses, the near ones stay.
    graph = table({(0, 1): [(0, 0)], (1, 2): [(0, 0)], (0, 2): [(9, 0)]})
    assert listed(graph) == [[(0, 0), (1, 0), (2, 0)]]


@pytest.mark.parametrize("frame", [1, 62, 63, 64, 65, 127, 128])
def test_a_track_of_many_frames_holds_no_two_keypoints_of_any(frame: int) -> None:
    """Frames are kept as bits of words of 64."""
    chain = {(i, i + 1): [(0, 0)] for i in range(130)}
    assert listed(table(chain)) == [[(i, 0) for i in range(131)]]
    other = {(0, frame): [(0, 9)]} if frame > 1 else {(1, 3): [(9, 0)]}
    assert listed(table({**chain, **other})) == [[(i, 0) for i in range(131)]]
    alone = {(frame, frame + 2): [(9, 9)]}
    assert listed(table({**chain, **alone})) == [[(i, 0) for i in range(131)], [(frame, 9), (frame + 2, 9)]]


def test_no_matches_give_no_tracks() -> None:
    assert listed(table({})) == []


def test_the_window_keeps_pairs_inside_it() -> None:
    graph = within(table({(0, 1): [(0, 0)], (1, 2): [(1, 1), (2, 2)], (2, 5): [(3, 3)]}), 1, 4)
    assert graph.pairs.tolist() == [[1, 2]]
    assert graph.inliers.tolist() == [[1, 1], [2, 2]]


def test_tracks_are_those_of_the_scene() -> None:
    scene = make_scene(10, 300)
    tracks = build_tracks(view_graph(scene))
    for a, b in zip(tracks.offsets[:-1], tracks.offsets[1:], strict=True):
        points = {int(scene.point[f][k]) for f, k in zip(tracks.frame[a:b], tracks.keypoint[a:b], strict=True)}
        assert len(points) == 1


def test_chosen_keypoints_are_few_spread_and_connected() -> None:
    scene = make_scene(10, 1500)
    graph, frames = view_graph(scene), frames_of(scene)
    chosen = choose_keypoints(build_tracks(graph), frames, 80)
    for frame, keypoints in chosen.items():
        assert 40 <= len(keypoints) <= 160 < len(scene.features[frame].keypoints)
        xy = frames.keypoints[frame][keypoints]
        assert np.ptp(xy[:, 0]) > 0.7 * WIDTH
        assert np.ptp(xy[:, 1]) > 0.7 * HEIGHT
    cache = thin_cache(graph, frames, chosen, 15)
    assert cache.num_images() == 10
    assert cache.correspondence_graph.num_image_pairs() == len(graph.pairs)


def test_as_many_keypoints_come_from_every_cell_of_the_frame() -> None:
    """Of three frames with four tracks in each cell, every cell gives as many as are wanted: its first ones."""
    columns, rows = GRID
    cells = [(x, y) for y in range(rows) for x in range(columns)]
    places = [((x + 0.2 + 0.2 * k) * WIDTH / columns, (y + 0.5) * HEIGHT / rows) for k in range(4) for x, y in cells]
    xy = np.array(places)
    frames = Frames((4, 7, 9), ("a", "b", "c"), (xy, xy[::-1].copy(), xy), camera_from_dict(LENS))
    n = len(xy)
    frame = np.tile([4, 7, 9], n)
    keypoint = np.column_stack([np.arange(n), n - 1 - np.arange(n), np.arange(n)]).ravel()
    tracks = Tracks(3 * np.arange(n + 1), frame, keypoint)
    for wanted in (1, 2):
        chosen = choose_keypoints(tracks, frames, wanted * len(cells))
        assert chosen[4].tolist() == chosen[9].tolist() == list(range(wanted * len(cells))), "the first tracks"
        assert chosen[7].tolist() == [n - 1 - k for k in range(wanted * len(cells))][::-1]
    everything = choose_keypoints(tracks, frames, 4 * len(cells))
    assert all(len(own) == n for own in everything.values())


def test_a_frame_with_its_keypoints_in_one_cell_gives_all_that_are_wanted_of_it() -> None:
    xy = np.tile([[1.0, 1.0]], (9, 1))
    frames = Frames((0, 1), ("a", "b"), (xy, xy), camera_from_dict(LENS))
    tracks = Tracks(2 * np.arange(10), np.tile([0, 1], 9), np.repeat(np.arange(9), 2))
    chosen = choose_keypoints(tracks, frames, 6)
    assert chosen[0].tolist() == chosen[1].tolist() == [0, 1, 2, 3, 4, 5]


def test_a_track_is_taken_while_half_of_it_is_wanted() -> None:
    """Frame 1 has two tracks in two cells; the second one's other half lies in a cell of frame 0 that is full."""
    near, far = [1.0, 1.0], [WIDTH - 1.0, HEIGHT - 1.0]
    keypoints = (np.array([near, near, near]), np.array([near, far, far]))
    frames = Frames((0, 1), ("a", "b"), keypoints, camera_from_dict(LENS))
    tracks = Tracks(np.array([0, 2, 4, 6]), np.tile([0, 1], 3), np.repeat(np.arange(3), 2))
    chosen = choose_keypoints(tracks, frames, 1)
    assert chosen[0].tolist() == chosen[1].tolist() == [0, 1], "the third is wanted in neither frame"


def test_the_thin_cache_keeps_places_and_matches() -> None:
    scene = make_scene(4, 600)
    graph, frames = view_graph(scene), frames_of(scene)
    chosen = choose_keypoints(build_tracks(graph), frames, 100)
    cache = thin_cache(graph, frames, chosen, 15)
    matches = cache.correspondence_graph.extract_matches_between_images(1, 2)
    assert len(matches) >= 15
    for first, second in matches:
        a, b = chosen[0][int(first)], chosen[1][int(second)]
        assert scene.point[0][a] == scene.point[1][b]
        np.testing.assert_allclose(cache.image(1).points2D[int(first)].xy, frames.keypoints[0][a])
