"""Files of OpenCV, Kalibr and COLMAP: the same lens out of each, and one clear error for what is none."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from core.calibration.documents import MAX_BYTES
from core.calibration.files import parse_calibration, read_calibration, write_calibration
from core.calibration.model import Calibration
from core.errors import BadInput
from core.geometry.lens import LensModel
from core.settings import make_settings

SIZE = (640, 480)
FISHEYE = (500.0, 501.0, 320.75, 240.5, 0.1, 0.01, -1e-05, 0.002)
RADTAN = (500.0, 501.0, 320.75, 240.5, -0.2, 0.05, 0.001, -0.0005)
PINHOLE = Calibration(LensModel.PINHOLE, (500.0, 500.0, 320.0, 240.0), SIZE)


def opencv(terms: list[float], form: str = ".yml", **more: str | float) -> bytes:
    """What cv2.FileStorage writes; ``more`` are further fields."""
    storage = cv2.FileStorage(form, cv2.FILE_STORAGE_WRITE | cv2.FILE_STORAGE_MEMORY)
    for name, value in {"image_width": 640, "image_height": 480, **more}.items():
        storage.write(name, value)
    storage.write("camera_matrix", np.array([[500.0, 0, 320.25], [0, 501.0, 240.0], [0, 0, 1]]))
    storage.write("distortion_coefficients", np.array(terms).reshape(1, -1))
    return storage.releaseAndGetString().encode()


def kalibr(distortion: str, terms: object, model: str = "pinhole") -> bytes:
    return (
        f"cam0:\n  camera_model: {model}\n  intrinsics: [500.0, 501.0, 320.25, 240.0]\n"
        f"  distortion_model: {distortion}\n  distortion_coeffs: {terms}\n  resolution: [640, 480]\n"
    ).encode()


def colmap(model: str, params: object) -> bytes:
    return f"# Camera list\n#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n1 {model} 640 480 {params}\n".encode()


def words(params: tuple[float, ...]) -> str:
    return " ".join(map(repr, params))


@pytest.mark.parametrize(
    ("data", "model", "params"),
    [
        *((opencv(list(FISHEYE[4:]), form), "OPENCV_FISHEYE", FISHEYE) for form in (".yml", ".json", ".xml")),
        *((opencv([*RADTAN[4:], 0.0], form), "OPENCV", RADTAN) for form in (".yml", ".json", ".xml")),
        (opencv(list(RADTAN[4:]), model="pinhole"), "OPENCV", RADTAN),
        (opencv(list(RADTAN[4:]), distortion_model="plumb_bob"), "OPENCV", RADTAN),
        (opencv(list(RADTAN[4:]), fisheye_model=0), "OPENCV", RADTAN),
        (kalibr("equidistant", list(FISHEYE[4:])), "OPENCV_FISHEYE", FISHEYE),
        (kalibr("radtan", list(RADTAN[4:])), "OPENCV", RADTAN),
        (kalibr("none", []), "PINHOLE", RADTAN[:4]),
        (colmap("OPENCV_FISHEYE", words(FISHEYE)), "OPENCV_FISHEYE", FISHEYE),
        (colmap("OPENCV", words(RADTAN)), "OPENCV", RADTAN),
        (colmap("PINHOLE", words(RADTAN[:4])), "PINHOLE", RADTAN[:4]),
        (colmap("SIMPLE_RADIAL", "500 320 240 -0.1"), "OPENCV", (500, 500, 320, 240, -0.1, 0, 0, 0)),
        (colmap("RADIAL_FISHEYE", "500 320 240 0.1 0.2"), "OPENCV_FISHEYE", (500, 500, 320, 240, 0.1, 0.2, 0, 0)),
    ],
)
def test_the_same_lens_comes_out_of_every_form(data: bytes, model: str, params: tuple[float, ...]) -> None:
    found = parse_calibration(data, "lens")
    assert (found.model, found.size_px) == (model, SIZE)
    assert found.params == pytest.approx(params, rel=1e-15, abs=1e-15)


@pytest.mark.parametrize(
    ("model", "params"), [("OPENCV_FISHEYE", FISHEYE), ("OPENCV", RADTAN), ("PINHOLE", RADTAN[:4])]
)
def test_what_we_write_we_read(model: str, params: tuple[float, ...], tmp_path: Path) -> None:
    calibration = Calibration(LensModel(model), params, SIZE)
    write_calibration(tmp_path / "lens.yml", calibration, {"board": "chessboard:9x6:10", "rms_px": 0.2})
    assert read_calibration(tmp_path / "lens.yml") == calibration
    settings = make_settings("default", calibration.options())
    assert (settings.camera.model, settings.camera.params, settings.camera.size_px) == (model, params, SIZE)
    assert not settings.mapper.refine_lens


def test_a_third_radial_term_is_taken_up_by_a_lens_that_shows_the_same() -> None:
    terms = [-0.2, 0.05, 0.0, 0.0, -0.01]
    found = parse_calibration(opencv(terms), "lens").lens
    K = np.array([[500.0, 0, 320.25], [0, 501.0, 240.0], [0, 0, 1]])
    places = np.array([[0.0, 0.0, 1.0], [0.3, 0.2, 1.0], [-0.6, 0.4, 1.0]])
    wanted, _ = cv2.projectPoints(places, np.zeros(3), np.zeros(3), K, np.array(terms))
    project = cv2.fisheye.projectPoints if found.fisheye else cv2.projectPoints
    own = np.array([[found.fx, 0, found.cx - 0.5], [0, found.fy, found.cy - 0.5], [0, 0, 1]])
    other = found.radial if found.fisheye else (*found.radial[:2], *found.tangential)
    shown, _ = project(places[:, None], np.zeros(3), np.zeros(3), own, np.array(other))
    assert np.abs(shown.reshape(-1, 2) - wanted.reshape(-1, 2)).max() < 0.5
    with pytest.raises(BadInput, match="turns back within its picture"):
        parse_calibration(opencv([-0.3, 0.08, 0.0, 0.0, -0.5]), "lens")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", "empty"),
        (b"\xff\xfe", "not text"),
        (b"a" * (MAX_BYTES + 1), "at most"),
        (b"a: [1,\n", "not valid YAML"),
        (b"a: &x [*x, *x]\n", "recursive"),
        (b"!!python/object/apply:os.system [ls]\n", "no fields"),
        (b"[" * 2000, "nested too deeply"),
        (b"{", "cannot be read"),
        (b"<a><b></a>", "not valid XML"),
        (b'<!DOCTYPE a [<!ENTITY x "y">]><a>&x;</a>', "document type"),
        (b"- 1\n- 2\n", "no fields"),
        (b"camera_matrix: [1, 2]\n", "it needs 9"),
        (opencv([0.0] * 4).replace(b"image_width", b"image_weight"), "'image_width' is missing"),
        (opencv([0.0] * 4).replace(b"500.", b".nan"), "no finite number"),
        (opencv([0.0, 0.0, float("nan"), 0.0]), "no finite number"),
        (opencv([0.0] * 3, model="fisheye"), "has 4 distortion coefficients"),
        (opencv([0.0] * 4, camera_model="double_sphere"), "'double_sphere' is not read"),
        (opencv([0.0] * 5 + [0.1, 0.0, 0.0]), "rational"),
        (opencv([0.0] * 4).replace(b"501.", b"640."), "not square"),
        (kalibr("equidistant", "[0, 0, 0, 0]", model="omni"), "'omni' is not read"),
        (kalibr("equidistant", "[0, 0, 0, 0]", model="ds"), "'ds' is not read"),
        (kalibr("fov", "[0.9]"), "'fov' is not read"),
        (kalibr("radtan", "[0, 0]"), "it needs 4"),
        (kalibr("none", "[]") + kalibr("none", "[]").replace(b"cam0", b"cam1"), "2 cameras"),
        (colmap("FULL_OPENCV", "1 2 3 4 5 6 7 8 9 10 11 12"), "'FULL_OPENCV' is not read"),
        (colmap("PINHOLE", "500 500 320"), "3 are given"),
        (colmap("PINHOLE", "nan 500 320 240"), "no finite number"),
        (colmap("PINHOLE", "500 400 320 240"), "not square"),
        (colmap("PINHOLE", "500 500 920 240"), "outside the picture"),
        (colmap("PINHOLE", "5 5 320 240"), "no lens"),
        (colmap("PINHOLE", "500 500 320 240") + b"2 PINHOLE 640 480 500 500 320 240\n", "2 cameras"),
    ],
)
def test_what_is_no_calibration_is_refused_with_the_reason(data: bytes, message: str) -> None:
    with pytest.raises(BadInput, match=message) as caught:
        parse_calibration(data, "lens.yml")
    assert caught.value.code in {"bad_calibration", "calibration_malformed", "calibration_xml_declares"}


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="No such file"):
        read_calibration(tmp_path / "absent.yml")


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"camera.params": [500, 500, 320, 240]}, "together"),
        ({"camera.size_px": [640, 480]}, "together"),
        ({"camera.params": [500, 500, 320, 240], "camera.size_px": [640, 480]}, "OPENCV_FISHEYE has the 8 parameters"),
        ({"camera.model": "PINHOLE", "camera.fov_deg": 175}, "sees less than"),
        (
            {**PINHOLE.options(), "camera.fov_deg": 80},
            "both",
        ),
    ],
)
def test_options_of_the_lens_agree(options: dict[str, object], message: str) -> None:
    with pytest.raises(BadInput, match=message):
        make_settings("default", options)


def test_a_calibration_may_be_refined_by_name() -> None:
    told = PINHOLE.options()
    assert make_settings("default", {**told, "mapper.refine_lens": True}).mapper.refine_lens
