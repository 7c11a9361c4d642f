"""The lens that a run finds, held against the true one: runs of scenes that end where the lens is chosen.

They take about half of a whole run's time, so that a change of the search is seen on more scenes and seeds. Where the
same lens is chosen nothing after it differs.
"""

from __future__ import annotations

import resource
import shutil
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from bench.accuracy.truth import Lens as TrueLens
from bench.accuracy.truth import load_truth
from bench.kept import Found, kept_or_new
from bench.scenes.make import make_missing
from bench.scenes.run import Column, program_digest
from bench.scenes.spec import Scene
from core.errors import StageFailed
from core.geometry.lens import Lens, make_lens
from core.graph import TaskSpec
from core.products.contract import Facts, Products
from core.products.front import CameraProduct, FramesProduct
from core.settings import Settings, make_settings
from core.videos import Recording
from store.graph import CORE_GRAPH
from worker.local_run import RunFolder, run_inspection
from worker.results import ResultFolders

LENS_HEAD = ("scene", "seed", "model", "focal length, px", "true", "off at the edge", "starts that agree", "CPU s")
_CHOSEN_BY = "camera"


def _until_the_lens(settings: Settings, facts: Mapping[str, Facts]) -> list[TaskSpec]:
    """The tasks of a run that the choice of the lens needs, and that one."""
    tasks = {task.key: task for task in CORE_GRAPH.expand(settings, facts)}
    wanted = {_CHOSEN_BY} if _CHOSEN_BY in tasks else set(tasks)
    for key in reversed(tasks):  # every task stands after those that it needs
        if key in wanted:
            wanted.update(tasks[key].depends)
    return [task for key, task in tasks.items() if key in wanted]


LENS_GRAPH = replace(CORE_GRAPH, expand=_until_the_lens, serves_from=())


def find_lens(out: Path, scene: Scene, column: Column, seed: int) -> Found:
    """What is found of a scene's lens: {scene, seed, model, focal_px, true_focal_px, edge_deg, agreement, cpu_s}.

    Args:
        out: folder of scenes and of what was found; a scene that is not there is rendered.
        scene: whose lens.
        column: preset and options.
        seed: of the run.
    """
    source = out / "scenes" / scene.name

    def make() -> Found:
        make_missing(scene, source)
        return {
            "scene": scene.name,
            "seed": seed,
            **_found(source, out / "runs/lens" / scene.name, scene, column, seed),
        }

    key = f"{scene.digest()[:16]}-{program_digest()[:16]}"
    return kept_or_new(out / f"results/lens-{column.name}" / f"{scene.name}-{seed}.json", key, make)


def _found(source: Path, run: Path, scene: Scene, column: Column, seed: int) -> Found:
    shutil.rmtree(run, ignore_errors=True)
    region = dict(zip(("roi.x0", "roi.y0", "roi.x1", "roi.y1"), scene.roi, strict=True))
    settings = make_settings(column.preset, {**region, **column.options, "seed": seed})
    before = _cpu_s()
    recordings = [Recording(source / "video.mp4", source / "annotations.json")]
    ended = run_inspection(recordings, run, settings, graph=LENS_GRAPH)
    facts = {one.key: one.facts for one in ResultFolders(RunFolder(run).results).all()}
    if _CHOSEN_BY not in facts:
        raise StageFailed(f"the run of {scene.name} ended without a lens: {ended.error}", where=scene.name)
    done, truth = Products(facts), load_truth(source / "truth").lens
    chosen, frames = done.of(CameraProduct, _CHOSEN_BY), done.of(FramesProduct, "frames")
    shutil.rmtree(run)
    # The frames of a run may be smaller than the video's.
    found = make_lens(chosen.model, chosen.params).scaled((frames.crop[2] - frames.crop[0]) / chosen.width)
    return {
        "model": chosen.model,
        "focal_px": found.focal_px,
        "true_focal_px": truth.focal_px,
        "edge_deg": edge_error_deg(truth, found),
        "agreement": chosen.agreement,
        "cpu_s": round(_cpu_s() - before, 1),
    }


def edge_error_deg(truth: TrueLens, found: Lens) -> float | None:
    """How far off the axis the found lens sees the middle of the picture's left and right edge, against the true one.

    None where the found lens does not reach the edge.
    """
    radius = truth.width / 2
    angle = found.angle_at(radius / found.focal_px)
    if angle is None:
        return None
    return float(np.rad2deg(angle - truth.angle(radius)))


def lens_cells(one: Found) -> list[str]:
    """A row of the table."""
    share = one["focal_px"] / one["true_focal_px"] - 1.0
    return [
        one["scene"],
        str(one["seed"]),
        one["model"],
        f"{one['focal_px']:.1f}",
        f"{one['true_focal_px']:.1f} ({share:+.1%})",
        "-" if one["edge_deg"] is None else f"{one['edge_deg']:+.2f} degrees",
        "-" if one["agreement"] is None else f"{one['agreement']:.0%}",
        f"{one['cpu_s']:.0f}",
    ]


def _cpu_s() -> float:
    """Seconds of processor that this process and its children that are over have used."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)
