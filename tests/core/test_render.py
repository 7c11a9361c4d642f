"""Rendering and viewpoints on scenes whose picture is known."""

from __future__ import annotations

import numpy as np
import pytest

from core.render import BACKGROUND_RGB, Renderer
from core.surface.ply import Mesh
from core.viewpoint import Viewpoint, choose_two, framed, main_axes, turned

Z, Y = np.array([0.0, 0, 1]), np.array([0.0, 1, 0])


def plate(z: float = 5.0, half: float = 1.0, steps: int = 21) -> Mesh:
    """A square plate facing the origin (normal -z): left half red as defect 3, right half grey."""
    axis = np.linspace(-half, half, steps)
    x, y = np.meshgrid(axis, axis)
    vertices = np.stack([x.ravel(), y.ravel(), np.full(x.size, z)], axis=1)
    index = np.arange(steps * steps).reshape(steps, steps)
    a, b, c, d = index[:-1, :-1].ravel(), index[:-1, 1:].ravel(), index[1:, 1:].ravel(), index[1:, :-1].ravel()
    faces = np.vstack([np.stack([a, c, b], axis=1), np.stack([a, d, c], axis=1)]).astype(np.int32)
    left = vertices[:, 0] < -0.05
    colors = np.where(left[:, None], (255, 0, 0), (180, 180, 180)).astype(np.uint8)
    return Mesh(vertices, faces, colors, extra={"defect_id": np.where(left, 3, -1).astype(np.int32)})


def test_a_plate_is_where_it_should_be() -> None:
    view = Viewpoint(np.zeros(3), np.array([1.0, 0, 0]), Y, Z, fov_deg=2 * np.degrees(np.arctan(0.4)))
    picture = Renderer(plate()).render(view, 80, 80)
    # Half field 0.4 at depth 5 is 2; the plate of half size 1 fills the middle half.
    inside = picture.rgb[22:58, 22:58].reshape(-1, 3)
    assert not (inside == BACKGROUND_RGB).all(axis=1).any()
    assert (picture.rgb[:18] == BACKGROUND_RGB).all()
    red, grey = picture.rgb[40, 28].astype(int), picture.rgb[40, 52].astype(int)
    assert red[0] > 120 > 60 > red[1]
    assert abs(grey[0] - grey[2]) < 5
    assert (picture.defect[22:58, 22:36] == 3).all()
    assert (picture.defect[22:58, 44:58] == -1).all()


def test_the_back_of_a_surface_shows_no_defects() -> None:
    behind = Viewpoint(np.array([0, 0, 10.0]), np.array([-1.0, 0, 0]), Y, -Z)
    picture = Renderer(plate()).render(behind, 60, 60)
    assert (picture.defect == -1).all()
    middle = picture.rgb[30, 35:45].astype(int)
    assert (np.ptp(middle, axis=1) < 12).all(), "plain grey"


def test_front_share_tells_a_surface_turned_inside_out() -> None:
    mesh, pose = plate(), np.hstack([np.eye(3), np.zeros((3, 1))])[None]
    turned_over = Mesh(mesh.vertices, np.ascontiguousarray(mesh.faces[:, ::-1]))
    assert Renderer(mesh).front_share(pose) == 1.0
    assert Renderer(turned_over).front_share(pose) == 0.0
    assert Renderer(mesh).front_share(np.zeros((0, 3, 4))) == 1.0


def test_framing_fills_the_picture_and_cuts_nothing() -> None:
    rng = np.random.default_rng(1)
    points = rng.uniform(-1, 1, (500, 3)) * [3.0, 0.5, 1.0] + [7, -2, 4]
    view = framed(points, Z, Y, 4 / 3)
    local = (points - view.center) @ np.stack([view.right, view.down, view.forward]).T
    tangent = np.abs(local[:, :2] / local[:, 2:])
    half = np.tan(np.radians(view.fov_deg / 2)) * np.array([4 / 3, 1])
    assert (local[:, 2] > 0).all()
    assert 0.85 < (tangent / half).max() <= 1.0


def test_main_axes_are_the_cameras_mean() -> None:
    poses = [
        np.hstack([np.stack([np.cross(d, f), d, f]), np.zeros((3, 1))])
        for f, d in (turned(Z, Y, yaw, 0) for yaw in (-20.0, 20.0))
    ]
    forward, down = main_axes(np.array(poses))
    assert forward == pytest.approx(Z)
    assert down == pytest.approx(Y)
    assert main_axes(np.zeros((0, 3, 4)))[0] == pytest.approx(Z)


def test_two_views_see_the_defect_from_well_different_sides() -> None:
    mesh = plate()
    renderer = Renderer(mesh)
    pose = np.hstack([np.eye(3), np.zeros((3, 1))])[None]
    first, second = choose_two(renderer.sketch, mesh.vertices, pose, 4 / 3)
    angle = np.degrees(np.arccos(first.forward @ second.forward))
    assert angle >= 44.9
    for view in (first, second):
        defect, _ = renderer.sketch(view, 80, 60)
        assert (defect == 3).sum() > 100
        assert view.forward @ Z > 0.3


def test_rendering_is_deterministic() -> None:
    view = framed(plate().vertices, Z, Y, 1.0)
    pictures = [Renderer(plate(), threads).render(view, 40, 40).rgb for threads in (1, 2)]
    assert (pictures[0] == pictures[1]).all()
