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

# A named volume takes over the owner of the folder that it covers.
RUN mkdir /data && chown bladeatlas:bladeatlas /data
USER bladeatlas
ENV PATH=/app/.venv/bin:$PATH BLADEATLAS_DATA_DIR=/data
VOLUME /data
EXPOSE 8000
CMD ["bladeatlas", "serve", "--host", "0.0.0.0", "--port", "8000"]
