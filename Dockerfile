FROM python:3.11-slim-bookworm

RUN useradd --create-home --uid 1000 bladeatlas
WORKDIR /app

# System libraries and Python packages first: they change seldom, the code often.
COPY pyproject.toml requirements.lock LICENSE README.md ./
COPY scripts ./scripts
RUN scripts/setup.sh --system
COPY api ./api
COPY bench ./bench
COPY cli ./cli
COPY core ./core
COPY migrations ./migrations
COPY store ./store
COPY worker ./worker
RUN scripts/setup.sh

USER bladeatlas
ENV PATH=/app/.venv/bin:$PATH
EXPOSE 8000
CMD ["uvicorn", "--factory", "api.app:create_app", "--host", "0.0.0.0", "--port", "8000"]
