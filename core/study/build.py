"""The folder of a study: what people open, and beside it the right answers for who evaluates it.

`study/` holds a page that asks nobody and the two scenes as their runs published them: a gallery and a page each.
`answers.json` stays with who runs the study; nothing in `study/` tells what is right.
"""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Mapping
from pathlib import Path

from core.errors import BadInput
from core.json_files import JsonObject, read_json, write_json
from core.outputs import DEFECTS, DETECTIONS, FRAMES, GALLERY, GALLERY_PAGE, SUMMARY, VIEWER, VIEWER_PAGE
from core.report.csv_form import read_csv
from core.study.questions import NOT_TOLD, QUESTIONS, task_id
from core.study.truth import UNKNOWN, Task, answers, boxed
from core.viewer.deliver import DATA as PAGE_DATA
from core.viewer.deliver import ascii_json, bundle, in_script, study_bundle

SCHEMA_VERSION = 1
STUDY = "study"
"""Folder that people open."""
ANSWERS = "answers.json"
"""Beside it: the right answers."""
DATA = "study.js"
SCENES = ("A", "B")
PRACTICE = "practice"


def build_study(results: tuple[Path, Path], out: Path, contact: str = "", practice: Path | None = None) -> list[str]:
    """Write the folder of a study of two results, and a third to practise on.

    Args:
        results: folders of two finished results, scenes A and B.
        out: folder to write; it may not hold a study already.
        contact: who answers questions, shown with the consent.
        practice: folder of a result that people may look around in before the clock runs.

    Returns:
        What the scenes cannot answer, in sentences.

    Raises:
        BadInput: a result lacks a gallery or a page, has several models or no finding, or the folder is taken.
    """
    if (out / ANSWERS).exists() or (out / STUDY).exists():
        raise BadInput(f"'{out}' holds a study already", code="folder_in_use", where="--out")
    named = dict(zip(SCENES, results, strict=True))
    rights = {name: _answers(folder) for name, folder in named.items()}
    shown: dict[str, Path] = {**named, **({} if practice is None else {PRACTICE: practice})}
    for folder in shown.values():
        _require_pages(folder)
    scenes = [_scene(name, folder) for name, folder in named.items()]
    tasks = [_task(task) for task in Task]
    key = json.dumps([_identity(named), scenes, tasks, {name: _rows(one) for name, one in rights.items()}])
    study = hashlib.sha256(key.encode()).hexdigest()[:12]
    page = out / STUDY
    try:
        for name, folder in shown.items():
            _copy_scene(folder, page / "scenes" / name)
        for file, content in study_bundle().items():
            (page / file).write_bytes(content)
        _write_data(page / DATA, study, contact, scenes, tasks, practice is not None)
        document = {"schema_version": SCHEMA_VERSION, "study": study}
        write_json(out / ANSWERS, {**document, "scenes": {name: _rows(one) for name, one in rights.items()}})
    except OSError as error:
        raise BadInput(f"the study cannot be written into '{out}': {error.strerror or error}", where="--out") from None
    return [f"scene {name}: {text}" for name, one in rights.items() for text in _lacks(one)]


def _answers(folder: Path) -> Mapping[Task, frozenset[str]]:
    right = answers(folder)
    if any(one.get("model") for one in read_json(folder / DEFECTS)):
        # The page shows one model at a time and the gallery all: a count would have two right answers.
        raise BadInput(f"'{folder}' has findings in several models: a scene needs one", where="RESULT")
    return right


def _require_pages(folder: Path) -> None:
    for path, command in ((GALLERY_PAGE, "run"), (VIEWER_PAGE, "view")):
        if not (folder / path).is_file():
            raise BadInput(f"'{folder}' has no {path}: `bladeatlas {command}` writes it", where="RESULT")


def _identity(named: Mapping[str, Path]) -> list[object]:
    """What makes this study another than one of other results."""
    return [read_json(folder / SUMMARY).get("fingerprint") for folder in named.values()]


def _scene(name: str, folder: Path) -> JsonObject:
    """A scene as the page of the study needs it."""
    row = boxed(folder)
    number = {int(one["index"]): one["source_index"] for one in read_csv(folder / FRAMES)}[row["frame_index"]]
    alone = sum(one["frame_index"] == row["frame_index"] for one in read_json(folder / DETECTIONS)) == 1
    return {"name": name, "box": _words_for(row, number, alone=alone)}


def _words_for(row: JsonObject, number: str, *, alone: bool) -> str:
    """Which box is meant, as a person finds it."""
    words = f"on frame {number} (at {row['time_s']:.2f} s)"
    if alone:
        return words
    x, y = (row["box_x1"] + row["box_x2"]) / 2, (row["box_y1"] + row["box_y2"]) / 2
    return f"{words} whose middle is {100 * x:.0f} % from the left and {100 * y:.0f} % from the top"


def _copy_scene(folder: Path, scene: Path) -> None:
    """The gallery and the page of a result; the page is today's, and told to keep nothing of what is done to it."""
    for part in (GALLERY, VIEWER):
        shutil.copytree(folder / part, scene / part)
    for file, content in bundle().items():
        (scene / VIEWER / file).write_bytes(content)
    with (scene / VIEWER / PAGE_DATA).open("a", encoding="ascii", newline="\n") as script:
        script.write("window.BLADEATLAS.forgets = true;\n")


def _task(task: Task) -> JsonObject:
    question = QUESTIONS[task]
    return {"id": task_id(task), "text": question.text, "kind": str(question.kind), "unit": question.unit}


def _rows(right: Mapping[Task, frozenset[str]]) -> JsonObject:
    return {task_id(task): sorted(right[task]) for task in Task}


def _write_data(
    path: Path, study: str, contact: str, scenes: list[JsonObject], tasks: list[JsonObject], practice: bool
) -> None:
    """The data of the page as a script, because a page that was opened as a file may read no other file."""
    told = {
        "schema_version": SCHEMA_VERSION,
        "study": study,
        "contact": contact,
        "scenes": scenes,
        "tasks": tasks,
        "practice": practice,
        "not_told": NOT_TOLD,
    }
    script = f"window.STUDY_DATA = {in_script(ascii_json(told))};\n"
    path.write_text(script, encoding="ascii", newline="\n")


def _lacks(right: Mapping[Task, frozenset[str]]) -> list[str]:
    """Questions that only "I cannot tell" answers rightly."""
    return [
        f'its tables do not hold "{QUESTIONS[task].text}": only "{NOT_TOLD}" is right there'
        for task in Task
        if right[task] == {UNKNOWN}
    ]
