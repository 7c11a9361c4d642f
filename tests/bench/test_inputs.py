"""A long video is made by joining, and a probe of it stays small."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from bench.inputs import LIMIT_MB, PIECE_S, RATE, make_long_video, probe_costs
from core.video.probe import probe_video


def test_a_video_of_any_length_is_made_by_joining(tmp_path: Path) -> None:
    video = tmp_path / "long.mp4"
    make_long_video(video, 320, 240, 3 * PIECE_S)
    table = probe_video(video)
    assert (table.info.n_frames, table.info.damage, table.info.repaired_times) == (3 * PIECE_S * RATE, (), 0)
    steps = [later.time_s - earlier.time_s for earlier, later in zip(table.rows, table.rows[1:], strict=False)]
    assert max(steps) - min(steps) < 1e-6
    assert [one.name for one in tmp_path.iterdir()] == ["long.mp4"]


def test_a_probe_stays_small(tmp_path: Path) -> None:
    video = tmp_path / "large.mp4"
    make_long_video(video, 320, 240, PIECE_S)
    memory, *_ = probe_costs(video).rows
    assert isinstance(memory.value, float)
    assert 20 < memory.value < LIMIT_MB


def test_a_probe_loads_only_what_decodes() -> None:
    script = "import sys, cli.main, cli.probe; print(*sorted({name.split('.')[0] for name in sys.modules}))"
    loaded = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.split()
    assert "av" in loaded
    assert not {"cv2", "scipy", "torch", "pycolmap", "open3d", "sqlalchemy", "celery"} & set(loaded)
