"""Stage `camera`: the lens that matching and mapping start from."""

from __future__ import annotations

from core.sparse.lens import choose_lens
from core.stage import StageResult, StageTask
from core.task_key import parts_of
from core.verification import write_camera


def run(task: StageTask) -> StageResult:
    """Write ``camera.json``: the user's field of view, the best estimate, or COLMAP's default."""
    starts = [task.facts[key] for key in parts_of(task.facts, "focal")]
    lens = choose_lens(task.facts["frames"], task.settings.camera, starts)
    write_camera(task.out, lens)
    task.report(1, 1, f"focal length {lens['params'][0]:.1f} px ({lens['focal_from']})")
    return StageResult(lens)
