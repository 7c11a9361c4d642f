"""Feature tracks of a window, and the few keypoints per frame that are enough to find the poses.

The cost of incremental mapping grows with the number of points, the accuracy of the poses hardly does. So the
search maps with the longest tracks only, spread over every frame, and triangulates all others afterwards
(`core.sparse.densify`). The idea of keeping a covering subset of the tracks is that of COLMAP's
`ba_global_ignore_redundant_points3D`; here it is applied before the mapping, to all of its steps.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pycolmap

from core.jit import compiled
from core.sparse.view_graph import Frames
from core.viewgraph import PairTable

GRID = (8, 6)
"""Cells over a frame, across and down."""

UNKNOWN = np.int64(-1)


@dataclass(frozen=True)
class Tracks:
    """Keypoints that are one 3D point by the verified matches; one per frame at most. Longest tracks first."""

    offsets: npt.NDArray[np.int64]
    """(n + 1,) observations of each track."""
    frame: npt.NDArray[np.int64]
    """(total,) frame index of each observation."""
    keypoint: npt.NDArray[np.int64]
    """(total,) keypoint index of each observation."""


def build_tracks(graph: PairTable) -> Tracks:
    """Join the inliers of `graph` into tracks, ties in length in the order of their first observation.

    Matches are joined one after the other, nearest frames first and of equally near ones the pair with more
    inliers; a match that would put two keypoints of one frame into a track is passed over. Plain connected
    components do not do: with matches of repeated texture a few of them swallow most of a window.
    """
    if len(graph.inliers) == 0:
        empty = np.zeros(0, dtype=np.int64)
        return Tracks(np.zeros(1, dtype=np.int64), empty, empty)
    width = np.int64(graph.inliers.max()) + 1
    order = np.lexsort((graph.pairs[:, 0], -graph.n_inliers, np.abs(graph.pairs[:, 1] - graph.pairs[:, 0])))
    row = np.concatenate([np.arange(graph.offsets[pair], graph.offsets[pair + 1]) for pair in order])
    pair = np.repeat(order, graph.n_inliers[order])
    nodes = graph.pairs[pair].astype(np.int64) * width + graph.inliers[row].astype(np.int64)
    used, edges = np.unique(nodes, return_inverse=True)
    frames, position = np.unique(used // width, return_inverse=True)
    label = _join(edges.reshape(-1, 2).astype(np.int64), position.astype(np.int64), len(frames))
    _, label, length = np.unique(label, return_inverse=True, return_counts=True)
    # A label is the lowest node of its track, so that equal lengths stay in the order of first observations.
    rank = np.empty(len(length), dtype=np.int64)
    rank[np.argsort(-length, kind="stable")] = np.arange(len(length))
    sorted_nodes = np.argsort(rank[label], kind="stable")
    lengths = np.sort(length)[::-1]
    many = int((lengths >= 2).sum())
    offsets = np.concatenate([[0], np.cumsum(lengths[:many])]).astype(np.int64)
    kept = used[sorted_nodes[: offsets[-1]]]
    return Tracks(offsets, kept // width, kept % width)


def choose_keypoints(tracks: Tracks, frames: Frames, count: int) -> dict[int, npt.NDArray[np.int64]]:
    """About `count` keypoints per frame: whole tracks, longest first, spread over a grid.

    A track is taken while at least half of its observations lie in cells that are not full yet.

    Returns:
        rising keypoint indices by frame index; a frame without tracks has none.
    """
    position = {frame: i for i, frame in enumerate(frames.indices)}
    row = np.array([position[int(frame)] for frame in tracks.frame], dtype=np.int64)
    cell = _cells(tracks, frames, row)
    occupied = np.zeros((len(frames.indices), GRID[0] * GRID[1]), dtype=bool)
    occupied[row, cell] = True
    quota = -(-count // np.maximum(1, occupied.sum(axis=1)))
    taken = _take(tracks.offsets, row, cell, quota.astype(np.int64), GRID[0] * GRID[1])
    kept = np.repeat(taken, np.diff(tracks.offsets))
    chosen: dict[int, npt.NDArray[np.int64]] = {}
    for i, frame in enumerate(frames.indices):
        chosen[frame] = np.sort(tracks.keypoint[kept & (row == i)])
    return chosen


def thin_cache(
    graph: PairTable, frames: Frames, chosen: dict[int, npt.NDArray[np.int64]], min_num_matches: int
) -> pycolmap.DatabaseCache:
    """`DatabaseCache` in memory with the chosen keypoints only; its keypoint indices are new.

    Pairs that keep fewer than `min_num_matches` inliers are left out, as `open_cache` does.
    """
    cache = pycolmap.DatabaseCache()
    cache.add_camera(frames.camera)
    rig = pycolmap.Rig(rig_id=1)
    rig.add_ref_sensor(frames.camera.sensor_id)
    cache.add_rig(rig)
    renumber: dict[int, npt.NDArray[np.int64]] = {}
    for frame, name, keypoints in zip(frames.indices, frames.names, frames.keypoints, strict=True):
        _add_image(cache, frame + 1, name, keypoints[chosen[frame]], int(frames.camera.camera_id))
        renumber[frame] = np.full(len(keypoints), UNKNOWN)
        renumber[frame][chosen[frame]] = np.arange(len(chosen[frame]))
    for i, (a, b) in enumerate(graph.pairs.tolist()):
        rows = graph.inliers[graph.offsets[i] : graph.offsets[i + 1]]
        matches = np.stack([renumber[a][rows[:, 0]], renumber[b][rows[:, 1]]], axis=1)
        matches = matches[(matches != UNKNOWN).all(axis=1)]
        if len(matches) >= min_num_matches:
            geometry = pycolmap.TwoViewGeometry()
            geometry.config = int(graph.config[i])
            geometry.inlier_matches = matches.astype(np.uint32)
            cache.correspondence_graph.add_two_view_geometry(a + 1, b + 1, geometry)
    cache.correspondence_graph.finalize()
    return cache


def _add_image(
    cache: pycolmap.DatabaseCache, image_id: int, name: str, keypoints: npt.NDArray[np.float64], camera_id: int
) -> None:
    image = pycolmap.Image(name=name, keypoints=keypoints, camera_id=camera_id, image_id=image_id)
    frame = pycolmap.Frame()
    frame.frame_id, frame.rig_id = image_id, 1
    frame.add_data_id(image.data_id)
    cache.add_frame(frame)
    image.frame_id = image_id
    cache.add_image(image)


def _cells(tracks: Tracks, frames: Frames, row: npt.NDArray[np.int64]) -> npt.NDArray[np.int64]:
    starts = np.concatenate([[0], np.cumsum([len(points) for points in frames.keypoints])])
    xy = np.concatenate(frames.keypoints)[starts[row] + tracks.keypoint]
    size = np.array([frames.camera.width, frames.camera.height], dtype=np.float64)
    column = np.clip((xy / size * np.array(GRID)).astype(np.int64), 0, np.array(GRID) - 1)
    cells: npt.NDArray[np.int64] = column[:, 1] * GRID[0] + column[:, 0]
    return cells


def _take_python(
    offsets: npt.NDArray[np.int64],
    row: npt.NDArray[np.int64],
    cell: npt.NDArray[np.int64],
    quota: npt.NDArray[np.int64],
    n_cells: int,
) -> npt.NDArray[np.bool_]:
    """Greedy choice of tracks in order, see `choose_keypoints`."""
    counts = np.zeros((len(quota), n_cells), dtype=np.int64)
    taken = np.zeros(len(offsets) - 1, dtype=np.bool_)
    for track in range(len(offsets) - 1):
        wanted = 0
        for o in range(offsets[track], offsets[track + 1]):
            if counts[row[o], cell[o]] < quota[row[o]]:
                wanted += 1
        if 2 * wanted >= offsets[track + 1] - offsets[track]:
            taken[track] = True
            for o in range(offsets[track], offsets[track + 1]):
                counts[row[o], cell[o]] += 1
    return taken


def _join_python(edges: npt.NDArray[np.int64], frame: npt.NDArray[np.int64], n_frames: int) -> npt.NDArray[np.int64]:
    """Union-find over `edges` (m, 2) in order; the lowest node of each track, for every node.

    Every root carries the set of its frames as bits, so that a conflict costs a few operations.
    """
    n, words = len(frame), (n_frames + 63) // 64
    parent = np.arange(n)
    seen = np.zeros((n, words), dtype=np.uint64)
    for node in range(n):
        seen[node, frame[node] // 64] = np.uint64(1) << np.uint64(frame[node] % 64)
    for k in range(len(edges)):
        a, b = edges[k, 0], edges[k, 1]
        while parent[a] != a:
            parent[a] = parent[parent[a]]
            a = parent[a]
        while parent[b] != b:
            parent[b] = parent[parent[b]]
            b = parent[b]
        if a == b:
            continue
        conflict = False
        for word in range(words):
            if seen[a, word] & seen[b, word] != 0:
                conflict = True
                break
        if conflict:
            continue
        low, high = min(a, b), max(a, b)
        parent[high] = low
        for word in range(words):
            seen[low, word] |= seen[high, word]
    for node in range(n):
        root = node
        while parent[root] != root:
            root = parent[root]
        parent[node] = root
    return parent


_take = compiled(_take_python)
_join = compiled(_join_python)
