"""The surface of the page: parts, numbers of triangles, and what stands in its GLB."""

from __future__ import annotations

import json
import struct
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from core.surface.colored_glb import GLTF_FROM_WORLD
from core.surface.ply import Mesh
from core.viewer.parts import SURFACE, part_name, viewer_parts
from core.viewer.quantized import write_quantized_glb
from tests.core.test_mapping_stages import plane

_TYPES = {5120: "<i1", 5121: "<u1", 5123: "<u2", 5125: "<u4"}
_WIDTH = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}


class Glb:
    """A GLB file taken apart by the words of its standard."""

    def __init__(self, path: Path) -> None:
        data = path.read_bytes()
        magic, version, total = struct.unpack_from("<4sII", data)
        assert (magic, version, total) == (b"glTF", 2, len(data))
        size = struct.unpack_from("<I", data, 12)[0]
        self.document: dict[str, Any] = json.loads(data[20 : 20 + size])
        self.binary = data[28 + size :]

    def node(self, name: str) -> dict[str, Any]:
        return next(node for node in self.document["nodes"] if node["name"] == name)

    def primitive(self, name: str) -> dict[str, Any]:
        found: dict[str, Any] = self.document["meshes"][self.node(name)["mesh"]]["primitives"][0]
        return found

    def values(self, accessor: int) -> NDArray[Any]:
        """Raw numbers of an accessor."""
        one = self.document["accessors"][accessor]
        kind, width = np.dtype(_TYPES[one["componentType"]]), _WIDTH[one["type"]]
        if "bufferView" not in one:
            return np.zeros((one["count"], width), kind)
        view = self.document["bufferViews"][one["bufferView"]]
        stride = view.get("byteStride", kind.itemsize * width)
        raw = np.frombuffer(self.binary, np.uint8, one["count"] * stride, view["byteOffset"])
        return np.ascontiguousarray(raw.reshape(-1, stride)[:, : kind.itemsize * width]).view(kind)

    def positions(self, name: str) -> NDArray[np.float64]:
        """In the world of the model: the node's own transform undoes the quantisation."""
        node = self.node(name)
        raw = self.values(self.primitive(name)["attributes"]["POSITION"]) / 65535
        return np.asarray(raw * node["scale"] + node["translation"])


def bumpy() -> Mesh:
    """A plane with hills, a colour and a support that say where a vertex is."""
    mesh = plane(61, 51)
    x, y, z = mesh.vertices.T
    height = z + 0.2 * np.sin(2 * x) * np.cos(3 * y)
    colors = np.stack([np.full(len(x), 10), (x + 3) * 40, (y + 3) * 40], axis=1).astype(np.uint8)
    support = ((x + 3) / 6).astype(np.float32)
    return replace(mesh, vertices=np.stack([x, y, height], axis=1), colors=colors, extra={"support": support})


def faces_near(mesh: Mesh, x: float, y: float, radius: float) -> list[int]:
    middle = mesh.vertices[mesh.faces].mean(axis=1)
    return [int(i) for i in np.flatnonzero(np.hypot(middle[:, 0] - x, middle[:, 1] - y) < radius)]


def area(mesh: Mesh) -> float:
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def test_defects_keep_every_triangle_and_the_rest_gets_fewer() -> None:
    mesh = bumpy()
    defects = {4: faces_near(mesh, 1.0, 1.0, 0.5), 7: faces_near(mesh, -1.5, 0.0, 0.4), 9: []}
    parts = viewer_parts(mesh, defects, 2000)
    assert list(parts) == [SURFACE, part_name(4), part_name(7)]
    assert len(parts["defect_4"].faces) == len(defects[4])
    corners = {tuple(vertex) for vertex in parts["defect_4"].vertices}
    assert corners == {tuple(vertex) for vertex in mesh.vertices[np.unique(mesh.faces[defects[4]])]}
    assert sum(len(part.faces) for part in parts.values()) <= 2000
    assert sum(area(part) for part in parts.values()) == pytest.approx(area(mesh), rel=0.02)


def test_the_rim_around_a_defect_stays_closed() -> None:
    mesh = bumpy()
    parts = viewer_parts(mesh, {0: faces_near(mesh, 0.0, 0.0, 0.8)}, 1500)
    patch, rest = parts["defect_0"], parts[SURFACE]
    inner = np.hypot(*patch.vertices[:, :2].T)
    rim = patch.vertices[inner > inner.max() - 0.05]
    distance, _ = cKDTree(rest.vertices).query(rim)
    assert np.median(distance) < 0.1, "the spacing of the plane's vertices"


def test_a_vertex_keeps_the_colour_and_support_of_its_place() -> None:
    mesh = bumpy()
    rest = viewer_parts(mesh, {}, 1200)[SURFACE]
    assert rest.colors is not None
    assert np.abs(rest.colors[:, 1] - (rest.vertices[:, 0] + 3) * 40).max() < 8
    assert np.abs(rest.extra["support"] - (rest.vertices[:, 0] + 3) / 6).max() < 0.03


def test_defects_larger_than_the_page_allows_lose_triangles_too() -> None:
    mesh = bumpy()
    parts = viewer_parts(mesh, {0: range(4000), 1: range(4000, 6000)}, 1000)
    assert sum(len(part.faces) for part in parts.values()) <= 1000
    assert len(parts["defect_0"].faces) > len(parts["defect_1"].faces) > 100


def test_a_face_of_two_defects_is_shown_once() -> None:
    mesh = bumpy()
    parts = viewer_parts(mesh, {0: [1, 2, 3], 5: [3, 4]})
    assert [len(part.faces) for part in parts.values()] == [len(mesh.faces) - 4, 3, 1]


def test_the_glb_gives_back_the_mesh(tmp_path: Path) -> None:
    mesh = bumpy()
    write_quantized_glb(tmp_path / "a.glb", viewer_parts(mesh, {3: faces_near(mesh, 0, 0, 1)}))
    glb = Glb(tmp_path / "a.glb")
    assert glb.document["extensionsRequired"] == ["KHR_mesh_quantization"]
    world = glb.node("world")
    children = [glb.document["nodes"][i]["name"] for i in world["children"]]
    assert children == [SURFACE, "defect_3"]
    assert glb.document["scenes"][0]["nodes"] == [glb.document["nodes"].index(world)]
    x, y, z, w = world["rotation"]
    half_turn = np.diag([1 - 2 * (y * y + z * z), 1 - 2 * (x * x + z * z), 1 - 2 * (x * x + y * y)])
    assert w == 0
    assert (half_turn == GLTF_FROM_WORLD).all()
    places = np.vstack([glb.positions(name) for name in children])
    distance, nearest = cKDTree(mesh.vertices).query(places)
    assert np.max(distance) < 6 / 65535
    colors = np.vstack([glb.values(glb.primitive(name)["attributes"]["COLOR_0"]) for name in children])
    assert mesh.colors is not None
    level: NDArray[np.float64] = mesh.colors[nearest] / 255
    linear = np.where(level <= 0.04045, level / 12.92, ((level + 0.055) / 1.055) ** 2.4)
    assert colors[:, :3] / 65535 == pytest.approx(np.asarray(linear), abs=1e-4)
    support = np.vstack([glb.values(glb.primitive(name)["attributes"]["_SUPPORT"]) for name in children])
    assert np.abs(support[:, 0] / 255 - mesh.extra["support"][nearest]).max() < 0.003
    normals = np.vstack([glb.values(glb.primitive(name)["attributes"]["NORMAL"]) for name in children])
    assert np.linalg.norm(normals / 127, axis=1) == pytest.approx(1, abs=0.02)
    faces = np.vstack([places_of(glb, name) for name in children])
    assert len(faces) == len(mesh.faces)
    turned = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])[:, 2]
    assert (turned < 0).all(), "counter-clockwise seen from the cameras, which look along +z"


def places_of(glb: Glb, name: str) -> NDArray[np.float64]:
    """(m, 3, 3) corners of the triangles of a node."""
    indices = glb.values(glb.primitive(name)["indices"]).ravel()
    return np.asarray(glb.positions(name)[indices.reshape(-1, 3)])


def test_attributes_begin_at_multiples_of_four_bytes(tmp_path: Path) -> None:
    write_quantized_glb(tmp_path / "a.glb", {SURFACE: bumpy()})
    glb = Glb(tmp_path / "a.glb")
    for number in glb.primitive(SURFACE)["attributes"].values():
        accessor = glb.document["accessors"][number]
        if "bufferView" in accessor:
            view = glb.document["bufferViews"][accessor["bufferView"]]
            assert view["byteOffset"] % 4 == 0
            assert view.get("byteStride", 4) % 4 == 0


def test_blades_cost_nothing_until_they_are_known(tmp_path: Path) -> None:
    mesh = bumpy()
    write_quantized_glb(tmp_path / "without.glb", {SURFACE: mesh})
    blade = np.where(mesh.vertices[:, 0] > 0, 2, 0)
    write_quantized_glb(tmp_path / "with.glb", {SURFACE: replace(mesh, extra={**mesh.extra, "blade": blade})})
    without, known = Glb(tmp_path / "without.glb"), Glb(tmp_path / "with.glb")
    assert not without.values(without.primitive(SURFACE)["attributes"]["_BLADE"]).any()
    assert (known.values(known.primitive(SURFACE)["attributes"]["_BLADE"]).ravel() == blade).all()
    assert len(known.binary) - len(without.binary) == 4 * len(mesh.vertices)


def test_a_node_has_as_many_primitives_as_two_bytes_need(tmp_path: Path) -> None:
    mesh = plane(400, 350)
    write_quantized_glb(tmp_path / "a.glb", {SURFACE: mesh})
    glb = Glb(tmp_path / "a.glb")
    node = glb.node(SURFACE)
    pieces = []
    for primitive in glb.document["meshes"][node["mesh"]]["primitives"]:
        indices = glb.values(primitive["indices"])
        assert indices.dtype == np.uint16
        assert indices.max() < 65535
        places = glb.values(primitive["attributes"]["POSITION"]) / 65535 * node["scale"] + node["translation"]
        pieces.append(places[indices.reshape(-1, 3)].mean(axis=1))
    assert len(pieces) == 4, "140,000 vertices: a half of them is still too many"
    middles = mesh.vertices[mesh.faces].mean(axis=1)
    distance, nearest = cKDTree(middles).query(np.vstack(pieces))
    assert np.max(distance) < 6 / 65535
    assert (np.sort(nearest) == np.arange(len(middles))).all(), "every triangle once"


def test_an_empty_surface_is_a_glb_too(tmp_path: Path) -> None:
    write_quantized_glb(tmp_path / "a.glb", {SURFACE: Mesh(np.zeros((0, 3)))})
    assert [node["name"] for node in Glb(tmp_path / "a.glb").document["nodes"]] == ["world"]


def test_what_lies_on_a_blade_is_a_node_and_nothing_is_lost(tmp_path: Path) -> None:
    mesh = bumpy()
    blade = np.where(mesh.vertices[:, 0] > 1.0, 3, np.where(mesh.vertices[:, 0] < -1.0, 2, 0)).astype(np.int32)
    defects = {7: range(20)}
    plain = viewer_parts(mesh, defects)
    parts = viewer_parts(replace(mesh, extra={**mesh.extra, "blade": blade}), defects)
    assert list(parts) == [SURFACE, "blade_2", "blade_3", part_name(7)]
    assert sum(len(part.faces) for part in parts.values()) == sum(len(part.faces) for part in plain.values())
    assert parts["blade_3"].vertices[:, 0].min() > 0.8
    write_quantized_glb(tmp_path / "s.glb", parts)
    glb = Glb(tmp_path / "s.glb")
    assert (glb.values(glb.primitive("blade_3")["attributes"]["_BLADE"]) == 3).mean() > 0.9
    corners = np.concatenate([part.vertices[part.faces].mean(axis=1) for part in parts.values()])
    same = np.concatenate([part.vertices[part.faces].mean(axis=1) for part in plain.values()])
    assert np.max(cKDTree(corners).query(same)[0]) < 1e-9
