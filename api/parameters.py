"""Kinds of values that come in queries."""

from __future__ import annotations

from typing import Annotated

from pydantic import AfterValidator, Field


def _without_nul(text: str) -> str:
    """PostgreSQL keeps no NUL in a text, so no row can have one."""
    if "\0" in text:
        raise ValueError("must not hold the character NUL")
    return text


Text = Annotated[str, Field(max_length=256), AfterValidator(_without_nul)]
"""A text to compare with a column."""
Seconds = Annotated[float, Field(ge=0, le=1e9, allow_inf_nan=False)]
"""A time in the video."""
Share = Annotated[float, Field(ge=0, le=1, allow_inf_nan=False)]
"""A number in [0, 1]."""
