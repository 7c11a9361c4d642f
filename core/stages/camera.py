"""Stage `camera`: the lens that matching and mapping start from."""

from __future__ import annotations

from core.products.front import CameraProduct, FocalProduct, FramesProduct
from core.sparse.lens import choose_lens
from core.stage import StageTask
from core.verification import write_camera


def run(task: StageTask) -> CameraProduct:
    """Write ``camera.json``: the user's field of view, the best estimate, or COLMAP's default."""
    starts = task.products.parts(FocalProduct, "focal")
    lens = choose_lens(task.products.of(FramesProduct, "frames"), task.settings.camera, starts)
    write_camera(task.out, lens.facts)
    task.report(1, 1, f"focal length {lens.params[0]:.1f} px ({lens.focal_from})")
    return lens
