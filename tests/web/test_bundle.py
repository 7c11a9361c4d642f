"""The committed page is what its sources build: anybody may build it again and compare."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from core.viewer.deliver import bundle, study_bundle

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
UNREACHED = (
    "ENOTFOUND",
    "EAI_AGAIN",
    "ECONNREFUSED",
    "ECONNRESET",
    "ENETUNREACH",
    "ETIMEDOUT",
    "No matching distribution",
)
"""What npm, and pip where there is no Node, say when their registry cannot be reached."""


def test_the_page_is_what_its_sources_build(tmp_path: Path) -> None:
    built = tmp_path / "bundle"
    built.mkdir()
    done = subprocess.run([ROOT / "scripts/web.sh", built], capture_output=True, text=True, timeout=300, check=False)
    if done.returncode and any(code in done.stderr for code in UNREACHED):
        pytest.skip("no registry of packages can be reached")
    assert done.returncode == 0, done.stderr
    assert {path.name: path.read_bytes() for path in built.iterdir() if path.is_file()} == bundle()
    assert {path.name: path.read_bytes() for path in (built / "study").iterdir()} == study_bundle()
