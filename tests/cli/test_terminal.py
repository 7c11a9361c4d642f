"""Nothing that a stranger wrote moves the terminal: labels, file names, messages of servers; and JSON stays exact."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import threading
import unicodedata
from http.server import BaseHTTPRequestHandler, HTTPServer
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from cli.main import main
from cli.terminal import guarded_stdout, say, say_json, visible
from tests.labels import LABELS, SAMPLE

ROOT = Path(__file__).parents[2]
EVIL = "evil\x1b[2J\x9b31m\u202e\x7f.mp4"
SHOWN = r"evil\x1b[2J\x9b31m\u202e\u007f.mp4"
BIDI = "\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"


def run(*words: str, **more: str) -> tuple[int, bytes, bytes]:
    """The real command in a process of its own: exit code, bytes of standard output and of standard error."""
    command = [sys.executable, "-m", "cli.main", *words]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, env={**os.environ, **more}, check=False)
    return done.returncode, done.stdout, done.stderr


def assert_tame(printed: bytes) -> None:
    text = printed.decode("utf-8")
    wild = [c for c in text if c != "\n" and (unicodedata.category(c) in ("Cc", "Zl", "Zp") or c in BIDI)]
    assert wild == []


@given(st.text(st.characters(exclude_categories=[])) | st.text(BIDI + "\x1b\x7f\x9b\u2028\n\ra裂"))
def test_a_visible_text_has_nothing_that_a_terminal_obeys(text: str) -> None:
    shown = visible(text)
    assert_tame(shown.encode("utf-8"))
    assert "\n" not in shown
    assert visible(shown) == shown


@pytest.mark.parametrize("text", ["dent", "裂纹", "🛠️ dent", 'Riß, "außen"', r"back\slash", ""])
def test_what_is_harmless_stays_as_it_is(text: str) -> None:
    assert visible(text) == text


def test_what_is_not_is_written_out(capsys: pytest.CaptureFixture[str]) -> None:
    say("a\nb", "\x1b[31m\r\t", "\u2028\u202e\udcff")
    assert capsys.readouterr().out == "a\\nb\n\\x1b[31m\\r\\t\n\\u2028\\u202e\\udcff\n"


def test_labels_and_file_names_in_what_commands_say(tmp_path: Path) -> None:
    video = tmp_path / EVIL
    video.symlink_to(SAMPLE)
    code, out, err = run("probe", str(video))
    assert (code, err) == (0, b"")
    assert_tame(out)
    assert out.startswith(SHOWN.encode())
    code, out, err = run("check", str(LABELS))
    assert (code, err) == (0, b"")
    assert_tame(out)
    assert rb"\x1b[31mred\x1b[0m" in out
    assert rb"\u202egnp.exe" in out
    assert "裂纹".encode() in out


def test_errors_are_one_line_whatever_the_file_is_called(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    video = tmp_path / f"two\nlines {EVIL}"
    video.write_bytes(b"no video")
    code, out, err = run("probe", str(video))
    assert (code, out) == (2, b"")
    said = [err.decode()]
    assert main(["run", str(video), "--out", str(tmp_path / "out")]) == 2
    said.append(capsys.readouterr().err)
    with pytest.raises(SystemExit, match="2"):
        main(["status", "x", f"two\nlines {EVIL}"])
    said.append(capsys.readouterr().err)
    for text in said:
        assert_tame(text.encode())
        assert text.count("\n") == 1
        assert rf"two\nlines {SHOWN}" in text


def test_json_is_exact_and_plain(tmp_path: Path) -> None:
    label = "\x1b[31m\x7f\x9b\u202e\n裂"
    file = tmp_path / "a.json"
    file.write_text(json.dumps({"0.0": {"detections": [{"label": label, "bbox": [0.1, 0.1, 0.2, 0.2], "score": 1}]}}))
    code, out, _ = run("check", str(file), "--json")
    assert code == 0
    assert json.loads(out)["detections_by_label"] == {label: 1}
    assert [byte for byte in out if not (0x20 <= byte < 0x7F or byte == 0x0A)] == []


def test_a_terminal_without_the_characters_gets_them_written_out() -> None:
    code, out, err = run("check", str(LABELS), PYTHONIOENCODING="ascii")
    assert (code, err) == (0, b"")
    assert out.isascii()
    assert rb"\u88c2\u7eb9" in out


def test_a_json_object_holds_del_as_json_spells_it(capsys: pytest.CaptureFixture[str]) -> None:
    with guarded_stdout():
        say_json({"a": "\x7f\n"})
        sys.stdout.write(json.dumps({"a": "\x7f\n"}) + "\n")
    assert capsys.readouterr().out == '{"a": "\\u007f\\n"}\n' * 2


class _Hostile(BaseHTTPRequestHandler):
    def do_GET(self) -> None:
        body = json.dumps({"detail": f"{EVIL}\nsecond line", "code": "bad\x1b"}).encode()
        self.send_response(404)
        self.send_header("Content-Type", "application/problem+json")
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, *_: object) -> None:
        """The test's output stays empty."""


def test_a_servers_message_is_one_tame_line(capsys: pytest.CaptureFixture[str]) -> None:
    server = HTTPServer(("127.0.0.1", 0), _Hostile)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    try:
        code = main(["status", "x", "--server", f"http://127.0.0.1:{server.server_port}"])
    finally:
        server.shutdown()
        server.server_close()
    assert code == 2
    assert capsys.readouterr().err == f"bladeatlas: {SHOWN}\\nsecond line\n"


def test_an_internal_error_shows_its_trace_without_obeying_it(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def broken() -> None:
        raise RuntimeError(EVIL)

    monkeypatch.setattr("cli.version.all_versions", broken)
    assert main(["--traceback", "version"]) == 1
    err = capsys.readouterr().err
    assert_tame(err.encode())
    assert "in broken" in err
    assert err.splitlines()[-1] == f"bladeatlas: internal error: RuntimeError: {SHOWN}"
