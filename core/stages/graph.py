"""Stage `graph`: all matches, those over gaps too, joined to one view graph, as arrays and as COLMAP's database."""

from __future__ import annotations

import json

import numpy as np

from core.features.io import feature_files, read_features
from core.matching.bridges import select
from core.stage import StageResult, StageTask
from core.verification import read_camera
from core.viewgraph import graph_facts, join_tables, read_table, write_database, write_table


def run(task: StageTask) -> StageResult:
    """Write ``graph.npz`` and ``database.db`` over all frames."""
    folders = [folder for _, folder in task.fan_in("matches")]
    if "bridge" in task.inputs:
        folders.append(task.input("bridge"))
    table = join_tables(read_table(folder / "pairs.npz") for folder in folders)
    if "bridge" in task.inputs:
        dropped = {tuple(pair) for pair in json.loads((task.input("bridge") / "dropped.json").read_text())}
        table = select(table, np.array([tuple(pair) not in dropped for pair in table.pairs.tolist()], bool))
    write_table(task.out / "graph.npz", table)
    task.report(0.2, 1, "writing the database")
    rows = json.loads((task.input("frames") / "frames.json").read_text(encoding="utf-8"))
    files = feature_files(folder for _, folder in task.fan_in("features"))
    camera = read_camera(task.input("camera") / "camera.json")
    keypoints = (read_features(files[index]).keypoints for index in range(len(rows)))
    write_database(task.out / "database.db", camera, keypoints, table)
    task.report(1, 1)
    return StageResult(graph_facts(table, len(rows)))
