"""What enters a stage's fingerprint."""

from __future__ import annotations

from core.graph import STAGES, stage_settings
from core.settings import make_settings


def test_another_stages_option_does_not_touch_frames() -> None:
    plain = stage_settings(make_settings(), STAGES["frames"])
    assert stage_settings(make_settings(options={"mapping.radius_fraction": 0.02}), STAGES["frames"]) == plain


def test_naming_an_own_option_counts_even_at_its_default() -> None:
    """A user's interval outside the video is an error, a preset's is cut: who set it matters."""
    plain = make_settings("thesis")
    named = make_settings("thesis", {"frames.clip_end_s": plain.frames.clip_end_s})
    assert stage_settings(named, STAGES["frames"]) != stage_settings(plain, STAGES["frames"])


def test_every_stage_reads_known_settings() -> None:
    for name, spec in STAGES.items():
        assert set(stage_settings(make_settings(), spec)) == set(spec.settings), name
