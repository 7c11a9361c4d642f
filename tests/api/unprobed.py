"""The application in a process of its own that takes any bytes for a video: for tests of what comes around the look."""

from __future__ import annotations

from typing import Any

from fastapi import FastAPI

from api import app
from api.probing import Prober


async def _check(*_: Any) -> None:
    return None


def create_app() -> FastAPI:
    """For `uvicorn --factory`."""
    Prober.check = _check  # type: ignore[method-assign,assignment]
    return app.create_app()
