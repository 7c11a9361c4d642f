"""Which files a run publishes."""

from __future__ import annotations

from core.outputs import OF_FURTHER_MODELS, OUTPUTS


def test_nothing_that_says_where_defects_are_is_published_of_a_refused_model() -> None:
    """Cameras, surfaces and the pictures may be looked at; places and what was learnt from them may not."""
    for outputs in (OUTPUTS, OF_FURTHER_MODELS):
        untrusted = {output.path for output in outputs if not output.needs_trust}
        surfaces = {"dense/fused.ply", "dense/mesh_poisson.ply", "dense/mesh_full.ply"}
        assert untrusted <= {"sparse", "gallery", "viewer/frames", "viewer/sprite.jpg"} | surfaces
        assert {output.path for output in outputs if output.needs_trust} == {
            "mapping/mesh_defects.ply",
            "mapping/mesh_defects.glb",
            "mapping/defect_points.ply",
            "mapping/confidence.json",
            "viewer/surface.glb",
            "row.json",
            "row_map.svg",
            "viewer/frames",
            "viewer/surface",
        }
