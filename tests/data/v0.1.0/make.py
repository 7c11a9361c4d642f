"""Makes the data of version 0.1.0: a service's data folder, a result folder, and what that version answered on them.

Run with a checkout of commit d4f1653 as working folder and PYTHONPATH; see README.md beside this file.
"""

from __future__ import annotations

import base64
import contextlib
import io
import json
import os
import shutil
import subprocess
import sys
import tarfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from itertools import cycle
from pathlib import Path
from typing import Any

import httpx
from bench.soak.clip import cut
from store.rows import replace_rows

from bench.soak.servers import free_port
from cli.main import main as bladeatlas
from store.db import Database, sqlite_url
from tests.api.test_results import ROWS

TUS = {"Tus-Resumable": "1.0.0"}
TABLES = ("cases", "metrics", "detections", "timeline", "defects", "stages", "quality")
ENDED = ("succeeded", "partial", "failed", "cancelled")
SERVICE = {
    "GRAPH": "bench.soak.toy:GRAPH",
    "RESERVE_BYTES": "0",
    "SWEEP_S": "0.5",
    "STALE_S": "1",
    "RETENTION_DAYS": "36500",
    "UPLOAD_HOURS": "876000",
}
"""Times to keep are a century: what is made here must not be out of date when it is used."""
RUN = {
    "preset": "draft",
    "label": "stage 2",
    "external_id": "WO-1187",
    "options": {
        "camera.fov_deg": 85,
        "dense.views": 8,
        "features.max_keypoints": 1500,
        "mesh.poisson_depth": 6,
        "gallery.render_width_px": 200,
        "gallery.render_height_px": 150,
    },
}
"""Parameters of the run: a small clip has a known lens, a few depth maps and a coarse surface."""


@contextmanager
def server(data: Path, **settings: str) -> Iterator[str]:
    """The embedded server of this version on a data folder; its address."""
    values = {**SERVICE, "DATA_DIR": str(data), **settings}
    port = free_port()
    process = subprocess.Popen(
        [sys.executable, "-m", "cli.main", "serve", "--port", str(port), "--workers", "2"],
        env={**os.environ, **{f"BLADEATLAS_{name}": value for name, value in values.items()}},
    )
    address = f"http://127.0.0.1:{port}"
    try:
        wait_for(lambda: answers(address))
        yield address
    finally:
        process.terminate()
        process.wait(30)


def answers(address: str) -> bool:
    """True once the server takes work."""
    with contextlib.suppress(httpx.TransportError):
        return httpx.get(f"{address}/readyz").status_code == 200
    return False


def wait_for(condition: Callable[[], bool]) -> None:
    """Wait until something holds; `TimeoutError` after two minutes."""
    deadline = time.monotonic() + 120
    while not condition():
        if time.monotonic() > deadline:
            raise TimeoutError
        time.sleep(0.1)


def upload(http: httpx.Client, data: bytes, sent: int) -> str:
    """Begin a resumable upload and send so many bytes of it; its id."""
    metadata = {"Upload-Metadata": f"filename {base64.b64encode(b'turbine.mp4').decode()}"}
    begun = http.post("/v1/uploads", headers={**TUS, **metadata, "Upload-Length": str(len(data))}).raise_for_status()
    location = str(begun.headers["Location"])
    kind = {"Content-Type": "application/offset+octet-stream", "Upload-Offset": "0"}
    http.patch(location, content=data[:sent], headers={**TUS, **kind}).raise_for_status()
    return location.rsplit("/", 1)[1]


def create(http: httpx.Client, files: tuple[Path, Path], name: str, **options: Any) -> str:
    """Start an inspection of uploaded files; its id."""
    video, annotations = (upload(http, path.read_bytes(), path.stat().st_size) for path in files)
    parameters = {"preset": "draft", "options": options, "label": "stage 2", "external_id": name}
    body = {"video_upload": video, "annotations_upload": annotations, "parameters": parameters}
    made = http.post("/v1/inspections", json=body, headers={"Idempotency-Key": name}).raise_for_status()
    return str(made.json()["id"])


def ended(http: httpx.Client, inspection: str) -> str:
    """State of an inspection once it is over and published."""
    wait_for(lambda: http.get(f"/v1/inspections/{inspection}").json()["state"] in ENDED)
    return str(http.get(f"/v1/inspections/{inspection}").json()["state"])


def keys(data: Path, *words: str) -> dict[str, str]:
    """What `bladeatlas keys` prints."""
    os.environ["BLADEATLAS_DATA_DIR"] = str(data)
    lines = said(["keys", *words]).splitlines()
    return json.loads(lines[0]) if lines else {}


def said(words: list[str]) -> str:
    """What a command prints; an error when it fails."""
    with contextlib.redirect_stdout(io.StringIO()) as printed:
        code = bladeatlas(words)
    if code:
        raise SystemExit(f"{words} ended with {code}")
    return printed.getvalue()


def write_rows(data: Path, *inspections: str) -> None:
    """Give inspections rows in every table, since the stages without vision write none."""
    database = Database(sqlite_url(data / "bladeatlas.db"))
    with database.write() as session:
        for inspection in inspections:
            replace_rows(session, inspection, ROWS)
    database.close()


def seen(http: httpx.Client, inspections: list[str]) -> dict[str, Any]:
    """Answers to GET by path; what lies below an inspection that is not shown is left out."""
    paths = ["/v1/inspections"]
    for url in (f"/v1/inspections/{one}" for one in inspections):
        shown = http.get(url).status_code == 200
        below = ["/artifacts", "/logs", *(f"/{table}{form}" for table in TABLES for form in ("", "?format=csv"))]
        paths += [url, *(url + path for path in below if shown)]
    return {path: _answer(http.get(path)) for path in paths}


def _answer(answer: httpx.Response) -> dict[str, Any]:
    text = answer.headers["content-type"].startswith("text/csv")
    return {"status": answer.status_code, "body": answer.text if text else answer.json()}


def make_service(data: Path, files: tuple[Path, Path]) -> dict[str, Any]:
    """Inspections of every end, keys, uploads; what the server answered about them."""
    with server(data) as address, httpx.Client(base_url=address, timeout=30) as http:
        names = {name: create(http, files, name) for name in ("ownerless", "deleted")}
        for one in names.values():
            assert ended(http, one) == "succeeded"
        http.delete(f"/v1/inspections/{names['deleted']}").raise_for_status()
        wait_for(lambda: not (data / "artifacts" / "inspections" / names["deleted"]).exists())
        names["cancelled"] = create(http, files, "cancelled", **{"frames.jpeg_quality": 80})
        http.post(f"/v1/inspections/{names['cancelled']}/cancel").raise_for_status()
        assert ended(http, names["cancelled"]) == "cancelled"
    write_rows(data, names["ownerless"])
    with server(data) as address, httpx.Client(base_url=address, timeout=30) as http:
        without_keys = seen(http, list(names.values()))
    made = {name: keys(data, "create", name, "--json") for name in ("inspector", "revoked")}
    bearer = {name: {"Authorization": f"Bearer {key['key']}"} for name, key in made.items()}
    with server(data) as address, httpx.Client(base_url=address, timeout=30, headers=bearer["inspector"]) as http:
        names["owned"] = create(http, files, "owned")
        assert ended(http, names["owned"]) == "succeeded"
        video = files[0].read_bytes()
        uploads = {"finished": upload(http, video, len(video)), "open": upload(http, video, len(video) // 2)}
    with server(data, TASK_SECONDS="0.05", MAX_ATTEMPTS="1") as address:
        with httpx.Client(base_url=address, timeout=30, headers=bearer["inspector"]) as http:
            names["failed"] = create(http, files, "failed", **{"frames.jpeg_quality": 70})
            assert ended(http, names["failed"]) == "failed"
        with httpx.Client(base_url=address, timeout=30, headers=bearer["revoked"]) as http:
            names["of_revoked"] = create(http, files, "of_revoked", **{"frames.jpeg_quality": 70})
            assert ended(http, names["of_revoked"]) == "failed"
    keys(data, "revoke", made["revoked"]["id"])
    write_rows(data, names["owned"])
    with server(data) as address, httpx.Client(base_url=address, timeout=30, headers=bearer["inspector"]) as http:
        with_key = seen(http, list(names.values()))
    return {
        "inspections": names,
        "uploads": uploads,
        "keys": {name: key["key"] for name, key in made.items()},
        "without_keys": without_keys,
        "with_key": with_key,
    }


def make_result(out: Path, files: tuple[Path, Path]) -> dict[str, Any]:
    """A run of all stages on the clip, and answers to questions about it."""
    parameters = files[0].with_name("parameters.json")
    parameters.write_text(json.dumps(RUN), encoding="utf-8")
    said(["run", *map(str, files), "--out", str(out), "--parameters", str(parameters)])
    frames = (out / "frames.csv").read_text(encoding="utf-8").splitlines()[1::6]
    sources = [line.split(",")[1] for line in frames]
    pixels = cycle(("150,130", "240,150", "2,2"))
    questions = [["point", "--frame", one, "--pixel", next(pixels)] for one in sources]
    defects = json.loads((out / "mapping" / "defects.json").read_text(encoding="utf-8"))
    questions += [["views", "--defect", str(record["id"]), "--limit", "5"] for record in defects]
    shown = [[*question, "--json"] for question in questions]
    return {"questions": [[one, json.loads(said([one[0], str(out), *one[1:]]))] for one in shown]}


def pack(target: Path, *folders: Path) -> None:
    """One archive of some folders."""
    with tarfile.open(target, "w:xz") as archive:
        for folder in folders:
            archive.add(folder, folder.name, filter=_of_nobody)


def _of_nobody(entry: tarfile.TarInfo) -> tarfile.TarInfo:
    return entry.replace(uid=0, gid=0, uname="", gname="", deep=False)


def main(place: Path, target: Path) -> None:
    """Make everything below the empty folder `place`, and put what the tests read into `target`."""
    sources = (Path("samples", "turbine.mp4"), Path("samples", "turbine.json"))
    made = {"service": make_service(place / "service", cut(*sources, place / "toy", frames=8, width=160))}
    pack(target / "service.tar.xz", place / "service")
    made["result"] = make_result(place / "result", cut(*sources, place / "input", frames=30, width=480))
    # Results of the stages are a cache, and large.
    shutil.rmtree(place / "result" / ".bladeatlas" / "results")
    pack(target / "result.tar.xz", place / "result", place / "input")
    for name, answered in made.items():
        (target / f"{name}.json").write_text(json.dumps(answered, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve())
