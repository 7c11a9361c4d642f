"""Stage `reverify`: after every case was rejected, the view graph as a perspective lens sees it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from core.errors import NoReconstruction
from core.matched_pair import MatchedPair
from core.products.front import FocalProduct, FocalSource, FramesProduct
from core.products.search import NoPartProduct, ReverifyProduct
from core.sparse import view_graph
from core.sparse.lens import choose_lens, of_model
from core.stage import StageTask
from core.verification import Verifier, read_camera, write_camera
from core.viewgraph import (
    PairTable,
    database_of,
    graph_counts,
    make_table,
    read_graph,
    write_database,
    write_graph,
)


def run(task: StageTask) -> ReverifyProduct:
    """Choose the lens of the perspective starts and verify again by it what was verified by the fisheye.

    Only the inliers of each pair are asked again: a fisheye of any focal length explains nearly all that a perspective
    lens does between two views, and the matchers are what costs. `NoReconstruction` when no start found a lens.
    """
    settings = of_model(task.settings, str(task.args["model"]))
    frames, starts = task.products.of(FramesProduct, "frames"), task.products.parts(FocalProduct, "focal")
    lens = choose_lens(frames, settings.camera, starts)
    if lens.focal_from != FocalSource.ESTIMATED:
        why = task.products.of(NoPartProduct, "reduce_parts").why
        raise NoReconstruction(f"{why}; no perspective lens was found either ({lens.reason})", where="search")
    write_camera(task.out, lens.facts)
    camera = read_camera(task.out)
    graph, n_frames = task.input("graph"), frames.n_frames
    keypoints = [xy.astype(np.float32) for xy in view_graph.read_frames(database_of(graph), 0, n_frames).keypoints]
    verifier = Verifier(camera, settings.verification, settings.seed)
    before, matched = read_graph(graph), list[MatchedPair]()
    for row, (first, second) in enumerate(before.pairs.tolist()):
        task.report(row, len(before.pairs), f"frames {first} and {second}")
        geometry = verifier.verify(keypoints[first], keypoints[second], _inliers(before, row))
        matched.append(MatchedPair(int(before.method[row]), int(before.n_matches[row]), geometry))
    table = make_table([(first, second) for first, second in before.pairs.tolist()], matched)
    write_graph(task.out, table)
    write_database(database_of(task.out), camera, keypoints, table)
    task.report(1, 1, f"focal length {lens.params[0]:.1f} px")
    return ReverifyProduct(**lens.__dict__, **graph_counts(table, n_frames))


def _inliers(table: PairTable, row: int) -> NDArray[np.uint32]:
    return table.inliers[table.offsets[row] : table.offsets[row + 1]]
