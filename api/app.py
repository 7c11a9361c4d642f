"""The HTTP application: `uvicorn --factory api.app:create_app`."""

from __future__ import annotations

from fastapi import FastAPI

from api import problems
from api.routes import health, options, system
from core.versions import program_version


def create_app() -> FastAPI:
    """Make the application with its routes and error handlers."""
    app = FastAPI(
        title="BladeAtlas",
        version=program_version(),
        summary="Borescope video and its annotations in, a 3D surface of the blades with every defect on it out.",
        responses={
            "default": {"model": problems.Problem, "description": "Any error, as application/problem+json (RFC 9457)"}
        },
    )
    problems.install(app)
    for module in (health, system, options):
        app.include_router(module.router)
    return app
