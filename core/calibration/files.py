"""Calibration files: those of OpenCV, Kalibr and COLMAP are read, told by what they hold; ours are OpenCV's.

OpenCV and Kalibr count pixel centres as whole numbers, COLMAP at halves: principal points are converted here.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from core.calibration.documents import MAX_BYTES, Document, document_of, is_colmap, refused, text_of
from core.calibration.model import Calibration, calibration_of, refitted
from core.errors import BadInput
from core.geometry.lens import PARAMETERS, Lens, make_lens

FISHEYE_NAMES = ("fisheye", "equidistant", "equi", "opencv_fisheye", "kannala_brandt4")
PERSPECTIVE_NAMES = ("pinhole", "plumb_bob", "radtan", "opencv", "rational_polynomial")
"""Names of models in files of OpenCV and ROS."""

_MODEL_FIELDS = ("model", "camera_model", "distortion_model")
_MATRIX_FIELDS = ("camera_matrix", "Camera_Matrix", "K")
_DISTORTION_FIELDS = ("distortion_coefficients", "Distortion_Coefficients", "dist_coeffs", "D")
_FISHEYE_TERMS = 4
_MAX_PERSPECTIVE_TERMS = 14
_HALF = 0.5


def read_calibration(path: Path) -> Calibration:
    """The calibration in a file; `BadInput` says what is wrong and names the file."""
    try:
        with path.open("rb") as stream:
            data = stream.read(MAX_BYTES + 1)
    except OSError as error:
        raise refused(f"the calibration cannot be read: {error.strerror}", str(path)) from None
    return parse_calibration(data, str(path))


def parse_calibration(data: bytes, where: str) -> Calibration:
    """The calibration in the bytes of a file.

    Args:
        data: of any of the three forms.
        where: name of the file, for errors.

    Raises:
        BadInput: `bad_calibration` for a file that is malformed or too large, lacks a field, holds a number that is
            not finite, several cameras, pixels that are not square, or a model that is not read.
    """
    text = text_of(data, where)
    if is_colmap(text):
        return _of_colmap(text, where)
    document = document_of(text, where)
    cameras = [name for name in document if name.startswith("cam") and name[3:].isdigit()]
    if len(cameras) > 1:
        raise refused(
            f"the file holds {len(cameras)} cameras ({', '.join(cameras)}); leave only that of the video", where
        )
    if cameras:
        return _of_kalibr(document[cameras[0]], f"{where}: {cameras[0]}")
    return _of_kalibr(document, where) if "intrinsics" in document else _of_opencv(document, where)


def _of_colmap(text: str, where: str) -> Calibration:
    """cameras.txt: CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]."""
    lines = [line.split() for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    if len(lines) != 1:
        raise refused(f"the file holds {len(lines)} cameras; leave only that of the video", where)
    _, model, width, height, *params = lines[0]
    names = PARAMETERS.get(model)
    if names is None:
        raise refused(f"the model '{model}' is not read; {', '.join(PARAMETERS)} are", where)
    if len(params) != len(names):
        raise refused(f"{model} has the {len(names)} parameters {', '.join(names)}; {len(params)} are given", where)
    lens = make_lens(model, [_number(value, name, where) for name, value in zip(names, params, strict=True)])
    return calibration_of(lens, (_whole(width, "WIDTH", where), _whole(height, "HEIGHT", where)), where)


def _of_kalibr(camera: object, where: str) -> Calibration:
    """One camera of a camchain: pinhole projection with equidistant, radtan or no distortion."""
    if not isinstance(camera, Mapping):
        raise refused("the camera has no fields", where)
    model = str(_field(camera, ("camera_model",), where))
    if model != "pinhole":
        raise refused(f"the camera model '{model}' is not read; 'pinhole' is", where)
    width, height = _list(camera, ("resolution",), where, 2)
    fx, fy, cx, cy = _numbers(camera, ("intrinsics",), where, 4)
    lens = Lens(fx, fy, cx + _HALF, cy + _HALF, fisheye=False)
    distortion = str(camera.get("distortion_model", "none"))
    if distortion == "equidistant":
        k1, k2, k3, k4 = _numbers(camera, ("distortion_coeffs",), where, 4)
        lens = replace(lens, radial=(k1, k2, k3, k4), fisheye=True)
    elif distortion == "radtan":
        k1, k2, p1, p2 = _numbers(camera, ("distortion_coeffs",), where, 4)
        lens = replace(lens, radial=(k1, k2, 0.0, 0.0), tangential=(p1, p2))
    elif distortion != "none":
        raise refused(f"the distortion model '{distortion}' is not read; 'equidistant', 'radtan' and 'none' are", where)
    return calibration_of(lens, (_whole(width, "resolution", where), _whole(height, "resolution", where)), where)


def _of_opencv(document: Document, where: str) -> Calibration:
    """Fields of cv2.FileStorage in YAML, JSON or XML, and ROS's camera_info, which has the same names."""
    root = document.get("opencv_storage", document)
    if not isinstance(root, Mapping):
        raise refused("the file holds no fields of a calibration", where)
    matrix = _numbers(root, _MATRIX_FIELDS, where, 9)
    fx, skew, cx, below, fy, cy, *last = matrix
    if skew != 0 or below != 0 or last != [0, 0, 1]:
        raise refused("the camera matrix is not [fx 0 cx; 0 fy cy; 0 0 1]", where)
    width, height = (_whole(_field(root, (name,), where), name, where) for name in ("image_width", "image_height"))
    terms = _numbers(root, _DISTORTION_FIELDS, where)
    lens = Lens(fx, fy, cx + _HALF, cy + _HALF, fisheye=_is_fisheye(root, len(terms), where))
    if lens.fisheye:
        if len(terms) != _FISHEYE_TERMS:
            raise refused(f"a fisheye has {_FISHEYE_TERMS} distortion coefficients; the file has {len(terms)}", where)
        k1, k2, k3, k4 = terms
        return calibration_of(replace(lens, radial=(k1, k2, k3, k4)), (width, height), where)
    if len(terms) > _MAX_PERSPECTIVE_TERMS:
        raise refused(f"the file has {len(terms)} distortion coefficients; OpenCV has at most 14", where)
    k1, k2, p1, p2, k3, *others = [*terms, *[0.0] * (5 - len(terms))]
    if any(others):
        text = "terms beyond k1, k2, p1, p2, k3 (rational, thin prism or tilted) are not read"
        raise refused(f"{text}; calibrate without them, or as a fisheye", where)
    lens = replace(lens, radial=(k1, k2, 0.0, 0.0), tangential=(p1, p2))
    calibration = calibration_of(lens, (width, height), where)
    return (
        calibration if k3 == 0 else calibration_of(refitted(lens, k3, (width, height), where), (width, height), where)
    )


def _is_fisheye(root: Mapping[str, object], n_terms: int, where: str) -> bool:
    """By the field of the model; without one by the number of coefficients, of which only a fisheye has four.

    OpenCV's perspective calibration writes five or more unless it is told otherwise.
    """
    if "fisheye_model" in root:  # of OpenCV's own example program
        return str(root["fisheye_model"]) not in ("0", "false", "False")
    for name in _MODEL_FIELDS:
        if name in root:
            model = str(root[name]).lower()
            if model in FISHEYE_NAMES:
                return True
            if model in PERSPECTIVE_NAMES:
                return False
            raise refused(f"the model '{root[name]}' is not read; 'fisheye' and 'pinhole' are", where)
    return n_terms == _FISHEYE_TERMS


def _field(fields: Mapping[str, object], names: Sequence[str], where: str) -> object:
    found = next((fields[name] for name in names if name in fields), None)
    if found is None:
        raise refused(f"the field '{names[0]}' is missing", where)
    return found


def _list(fields: Mapping[str, object], names: Sequence[str], where: str, count: int | None = None) -> list[object]:
    """The values of a list or of an OpenCV matrix, row by row."""
    value = _field(fields, names, where)
    if isinstance(value, Mapping):
        value = value.get("data")
    if isinstance(value, str):  # XML writes numbers with spaces between them
        value = value.split()
    if isinstance(value, list) and value and all(isinstance(row, list) for row in value):
        value = [item for row in value for item in row]
    if not isinstance(value, list):
        raise refused(f"'{names[0]}' is no list of numbers", where)
    if count is not None and len(value) != count:
        raise refused(f"'{names[0]}' has {len(value)} numbers; it needs {count}", where)
    return value


def _numbers(fields: Mapping[str, object], names: Sequence[str], where: str, count: int | None = None) -> list[float]:
    return [_number(value, names[0], where) for value in _list(fields, names, where, count)]


def _number(value: object, name: str, where: str) -> float:
    try:
        number = float(str(value))
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        raise refused(f"'{name}' holds {value!r}, which is no finite number", where)
    return number


def _whole(value: object, name: str, where: str) -> int:
    number = _number(value, name, where)
    if number != int(number) or number <= 0:
        raise refused(f"'{name}' is {value!r}; it needs to be a number of pixels", where)
    return int(number)


def write_calibration(path: Path, calibration: Calibration, notes: Mapping[str, str | int | float]) -> None:
    """Write a calibration of OpenCV's fisheye or perspective model as a YAML file of cv2.FileStorage.

    Args:
        path: of the file, replaced when there is one.
        calibration: of OPENCV_FISHEYE, OPENCV or PINHOLE.
        notes: further fields, numbers or plain texts, which readers pass over.

    Raises:
        BadInput: the file cannot be written.
    """
    lens = calibration.lens
    k1, k2, k3, k4 = lens.radial
    terms = [k1, k2, k3, k4] if lens.fisheye else [k1, k2, *lens.tangential, 0.0]
    matrix = [lens.fx, 0.0, lens.cx - _HALF, 0.0, lens.fy, lens.cy - _HALF, 0.0, 0.0, 1.0]
    fields: dict[str, object] = {
        "image_width": calibration.size_px[0],
        "image_height": calibration.size_px[1],
        "model": FISHEYE_NAMES[0] if lens.fisheye else PERSPECTIVE_NAMES[0],
        **{name: f'"{value}"' if isinstance(value, str) else value for name, value in notes.items()},
    }
    lines = ["%YAML:1.0", "---", *(f"{name}: {value}" for name, value in fields.items())]
    for name, rows, values in ((_MATRIX_FIELDS[0], 3, matrix), (_DISTORTION_FIELDS[0], len(terms), terms)):
        data = ", ".join(repr(float(value)) for value in values)
        lines += [f"{name}: !!opencv-matrix", f"   rows: {rows}", f"   cols: {len(values) // rows}", "   dt: d"]
        lines.append(f"   data: [ {data} ]")
    try:
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    except OSError as error:
        raise BadInput(
            f"'{path}' cannot be written: {error.strerror}", code="unwritable_file", where=str(path)
        ) from None
