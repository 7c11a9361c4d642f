"""Stage `undistort`: pinhole images, the PINHOLE model, and the plan of depth maps."""

from __future__ import annotations

import cv2
import numpy as np

from core.dense.cameras import choose_pinhole
from core.dense.cuda import resolve_method
from core.dense.maps import write_mask
from core.dense.undistort import pinhole_model, undistort_map
from core.dense.views import plan_views, sparse_views, write_views
from core.errors import StageFailed
from core.io.frames import images_folder
from core.io.sparse import read_model
from core.products.search import SubmodelsProduct
from core.products.surface import UndistortProduct
from core.settings.groups import DenseSettings
from core.stage import StageTask

JPEG_QUALITY = 97


MIN_SUBMODEL_VIEWS = 10
"""Depth maps of a further model, at least."""


def run(task: StageTask) -> UndistortProduct:
    """Write ``images/``, ``mask.png``, ``sparse/`` and ``views.json``."""
    settings = task.settings.dense
    resolve_method(settings)  # a demand that cannot be met is refused before the work, not after
    model = read_model(task.input("extend"))
    views = sparse_views(model)
    plan = plan_views(views, _of_its_share(task))
    if not plan:
        raise StageFailed("no two registered images see the same points from different places", where="undistort")
    needed = sorted({name for view in plan for name in (view.name, *view.sources)})
    by_name = dict(zip(views.names, views.image_ids, strict=True))
    camera = model.cameras[model.images[views.image_ids[0]].camera_id]
    pinhole = choose_pinhole(camera, settings)
    mapping = undistort_map(camera, pinhole)

    sparse = task.out / "sparse"
    sparse.mkdir()
    pinhole_model(model, pinhole, [by_name[name] for name in needed]).write(str(sparse))
    images = task.out / "images"
    images.mkdir()
    for done, name in enumerate(needed):
        task.report(done, len(needed), name)
        image = cv2.imread(str(images_folder(task.input("frames")) / name), cv2.IMREAD_COLOR)
        if image is None:
            raise StageFailed(f"frame {name} cannot be read", where=name)
        cv2.imwrite(
            str(images / name), mapping.apply(np.asarray(image, np.uint8)), [cv2.IMWRITE_JPEG_QUALITY, JPEG_QUALITY]
        )
    write_mask(task.out, mapping.inside)
    write_views(task.out, plan)
    return UndistortProduct(
        n_views=len(plan),
        n_images=len(needed),
        width=pinhole.width,
        height=pinhole.height,
        focal_px=round(pinhole.focal_px, 3),
    )


def _of_its_share(task: StageTask) -> DenseSettings:
    """A further model has depth maps by its share of the registered frames: the budget is that of the run."""
    settings = task.settings.dense
    if not task.submodel or not settings.views:
        return settings
    found = task.products.of(SubmodelsProduct, "pieces")
    counts = [found.registered_first, *found.registered_images]
    share = counts[task.submodel] / sum(counts)
    return settings.model_copy(update={"views": max(MIN_SUBMODEL_VIEWS, round(share * settings.views))})
