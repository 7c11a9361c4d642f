"""Pairs beyond the sequence, sought where the view graph is thin: over a dark or blurred stretch, or a jump.

What such a pair says is believed only together with others. Blades look alike, so one verified pair may join two
different ones; pairs that join the same two components must agree on how these are turned to each other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import breadth_first_order, connected_components, minimum_spanning_tree
from scipy.spatial.transform import Rotation

from core.verification import STRONG_INLIERS
from core.viewgraph import PairTable

I64 = NDArray[np.int64]
Bool = NDArray[np.bool_]

THIN_SHARE = 0.2
"""Of the pairs tried across a place of the sequence; with fewer strong ones it is thin."""
MIN_DEGREE = 2
"""Strong pairs of a frame that is worth matching further: a black one has none."""
SIDE = 6
"""Frames on either side of a gap, each matched with each; between two components all of them are tried."""
COMPONENT_FRAMES = 8
"""Components of the graph with fewer frames are not sought out."""
COMPONENT_SIDE = 5
"""Frames spread over each of two components, each matched with each."""
MAX_COMPONENTS = 4
MAX_PAIRS = 300
PROBES = 6
"""Pairs inside a component, or spread over two, that are tried first; the others only if one of these holds."""
AGREE_DEG = 4.0
MIN_AGREEING = 3
"""Pairs that must agree before they join two components; the motion before and after counts as one of them."""
MOTION_FRAMES = 10
"""Frames before and after a gap that say how fast the view turns there."""


def is_strong(table: PairTable) -> Bool:
    """(m,) which pairs can carry a model."""
    strong: Bool = table.n_inliers >= STRONG_INLIERS
    return strong


def find_gaps(table: PairTable, n_search: int) -> list[tuple[int, int]]:
    """Thin stretches of the sequence as (last frame before, first frame after).

    Args:
        table: all pairs tried along the sequence.
        n_search: frames of the sequence; later ones are out of order and do not count.
    """
    tried, strong = np.zeros(n_search, np.int64), np.zeros(n_search, np.int64)
    for (first, second), carries in zip(table.pairs.tolist(), is_strong(table).tolist(), strict=True):
        if second < n_search:
            tried[first:second] += 1
            strong[first:second] += carries
    thin = strong[: n_search - 1] < np.maximum(1.0, THIN_SHARE * tried[: n_search - 1])
    edges = np.flatnonzero(np.diff(np.concatenate([[0], thin.astype(np.int64), [0]])))
    return [(int(start), int(end)) for start, end in zip(edges[::2], edges[1::2], strict=True)]


def components_of(table: PairTable, n_frames: int) -> I64:
    """(n_frames,) number of the component that strong pairs join each frame into."""
    first, second = table.pairs[is_strong(table)].T
    links = coo_matrix((np.ones(len(first), np.int8), (first, second)), shape=(n_frames, n_frames))
    labels: I64 = connected_components(links, directed=False)[1].astype(np.int64)
    return labels


Pair = tuple[int, int]


@dataclass(frozen=True)
class Place:
    """Where the view graph is thin, and the pairs to strengthen it with, the nearest in time first."""

    pairs: Sequence[Pair]
    probes: int
    """So many of the pairs are tried first, the others only if one of these holds."""


def bridge_places(table: PairTable, n_search: int) -> list[Place]:
    """Further pairs worth trying, at most `MAX_PAIRS` in all; no pair occurs twice.

    The places are, in this order: the gaps between two components, those of the largest components first; thin places
    inside a component; every two of the large components, at frames spread over them.
    """
    degree = np.bincount(table.pairs[is_strong(table)].ravel(), minlength=n_search)[:n_search]
    usable = np.flatnonzero(degree >= MIN_DEGREE)
    labels = components_of(table, n_search)
    components = [usable[labels[usable] == label] for label in np.unique(labels[usable])]
    wanted = [_near(left[-SIDE:], right[:SIDE]) for left, right in facing(components)]
    for before, after in find_gaps(table, n_search):
        left, right = usable[usable <= before][-SIDE:], usable[usable >= after][:SIDE]
        if len(left) and len(right) and labels[left[-1]] == labels[right[0]]:
            wanted.append(_near(left, right, PROBES))
    large = sorted(
        (component for component in components if len(component) >= COMPONENT_FRAMES), key=len, reverse=True
    )[:MAX_COMPONENTS]
    for row, one in enumerate(large):
        wanted += [_near(_spread(one), _spread(other), PROBES) for other in large[row + 1 :]]
    known = {(int(a), int(b)) for a, b in table.pairs}
    places: list[Place] = []
    for place in wanted:
        own = [pair for pair in place.pairs if pair not in known][: MAX_PAIRS - sum(len(one.pairs) for one in places)]
        known.update(own)
        if own:
            places.append(Place(own, place.probes))
    return places


def facing(components: Sequence[I64]) -> list[tuple[I64, I64]]:
    """Every two components with none between them as large as the smaller, the earlier first in each.

    A dark stretch verifies within itself and is a component: the light before it faces the light after it all the same.

    Args:
        components: frames of each, rising; the components in the order of their first frames.

    Returns:
        those of the largest components first, of equals the earliest.
    """
    found = [
        (one, other)
        for row, one in enumerate(components)
        for column, other in enumerate(components[row + 1 :], row + 1)
        if all(len(between) < min(len(one), len(other)) for between in components[row + 1 : column])
    ]
    return sorted(found, key=lambda two: -min(len(component) for component in two))


def _near(one: I64, other: I64, probes: int = MAX_PAIRS) -> Place:
    """Each frame of one side with each of the other."""
    pairs = [(int(min(a, b)), int(max(a, b))) for a in one for b in other]
    return Place(sorted(pairs, key=lambda pair: (pair[1] - pair[0], pair)), probes)


def _spread(frames: I64) -> I64:
    rows = np.linspace(0, len(frames) - 1, min(COMPONENT_SIDE, len(frames))).round().astype(int)
    return np.asarray(frames[np.unique(rows)], np.int64)


def agreeing(table: PairTable, extra: PairTable, n_frames: int, n_search: int) -> Bool:
    """(m,) which pairs of `extra` to believe.

    Those within one component of `table` are. Between two components, the rotations measured along the sequence carry
    every pair to one rotation between the components; the largest group that agrees on it is believed if it is most of
    them and has `MIN_AGREEING` members, of which the motion before and after the gap is one where it leads to the same
    rotation.

    Args:
        table: pairs of the sequence.
        extra: pairs beyond it.
        n_frames: frames in all.
        n_search: frames from this on are out of order and tell nothing of the motion.
    """
    labels = components_of(table, n_frames)
    turned = _rotations(table, labels)
    strong = is_strong(extra)
    ends = labels[extra.pairs]
    believed: Bool = strong & (ends[:, 0] == ends[:, 1])
    across = strong & ~believed
    joins = np.sort(ends, axis=1)
    for join in np.unique(joins[across], axis=0):
        rows = np.flatnonzero(across & (joins == join).all(axis=1))
        said = _between_components(extra, rows, labels, turned)
        group = _largest_group(said)
        foreseen = _by_motion(join, labels[:n_search], turned)
        confirmed = foreseen is not None and _apart_deg(foreseen, said[group[0]]) <= AGREE_DEG
        if len(group) + confirmed >= MIN_AGREEING and 2 * len(group) > len(rows):
            believed[rows[group]] = True
    return believed


def _by_motion(join: I64, labels: I64, turned: Sequence[Rotation]) -> Rotation | None:
    """How the component with the higher label is turned against the other, if the view went on turning over the gap.

    None where the components do not follow each other, one of them is too short, or the view does not turn alike before
    and after.
    """
    early, late = sorted(
        (np.flatnonzero(labels == label) for label in join), key=lambda frames: int(frames.min(initial=-1))
    )
    if min(len(early), len(late)) <= MOTION_FRAMES or early[-1] > late[0]:
        return None
    last, first = int(early[-1]), int(late[0])
    before, after = int(early[-1 - MOTION_FRAMES]), int(late[MOTION_FRAMES])
    rates = [
        (turned[last] * turned[before].inv()).as_rotvec() / (last - before),
        (turned[after] * turned[first].inv()).as_rotvec() / (after - first),
    ]
    gap = first - last
    if np.degrees(np.linalg.norm(rates[1] - rates[0])) * gap > AGREE_DEG:
        return None
    over = Rotation.from_rotvec((rates[0] + rates[1]) / 2 * gap)
    late_from_early = turned[first].inv() * over * turned[last]
    return late_from_early if labels[last] == join[0] else late_from_early.inv()


def _apart_deg(one: Rotation, other: Rotation) -> float:
    return float(np.degrees((one.inv() * other).magnitude()))


def _rotations(table: PairTable, labels: I64) -> list[Rotation]:
    """Rotation of every frame against the first of its component, chained over the pairs with most inliers."""
    strong = np.flatnonzero(is_strong(table))
    n = len(labels)
    first, second = table.pairs[strong].T
    cost = 1.0 / table.n_inliers[strong]
    tree = minimum_spanning_tree(coo_matrix((cost, (first, second)), shape=(n, n)).tocsr())
    measured = {
        (int(a), int(b)): Rotation.from_quat(q)
        for (a, b), q in zip(table.pairs[strong], table.rotation_xyzw[strong], strict=True)
    }
    found = [Rotation.identity()] * n
    for label in np.unique(labels):
        root = int(np.flatnonzero(labels == label)[0])
        order, before = breadth_first_order(tree, root, directed=False)
        for frame in order[1:]:
            a, b = int(before[frame]), int(frame)
            step = measured[a, b] if a < b else measured[b, a].inv()
            found[b] = step * found[a]
    return found


def _between_components(extra: PairTable, rows: I64, labels: I64, turned: Sequence[Rotation]) -> list[Rotation]:
    """What each pair says of how the component with the higher label is turned against that with the lower."""
    found = []
    for row in rows:
        first, second = (int(frame) for frame in extra.pairs[row])
        low_to_high = turned[second].inv() * Rotation.from_quat(extra.rotation_xyzw[row]) * turned[first]
        found.append(low_to_high if labels[first] < labels[second] else low_to_high.inv())
    return found


def _largest_group(rotations: Sequence[Rotation]) -> I64:
    """Rows of the rotations within `AGREE_DEG` of the one that most are near to."""
    near = [np.flatnonzero([_apart_deg(one, other) <= AGREE_DEG for other in rotations]) for one in rotations]
    return max(near, key=len).astype(np.int64)


def select(table: PairTable, keep: Bool) -> PairTable:
    """The rows of `table` that `keep` names, without their inliers where it does not: the pair was tried in vain."""
    counts = np.where(keep, table.n_inliers, 0)
    rows = [np.arange(table.offsets[i], table.offsets[i] + counts[i]) for i in range(len(counts))]
    inliers = table.inliers[np.concatenate([np.empty(0, np.int64), *rows])]
    return PairTable(
        table.pairs,
        table.method,
        table.n_matches,
        table.config,
        np.cumsum([0, *counts]).astype(np.int64),
        inliers,
        table.rotation_xyzw,
        table.translation,
        table.triangulation_angle_deg,
    )
