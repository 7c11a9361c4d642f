# Two images from one file, told apart by arguments: docker-compose.yml gives those of the GPU worker. Every step is one of
# scripts/setup.sh, which `make setup` runs too.
FROM python:3.11-slim-bookworm

RUN useradd --create-home --uid 1000 bladeatlas
WORKDIR /app
# cpu, cuda or default, and pycolmap or pycolmap-cuda12: see scripts/setup.sh.
ARG TORCH_BUILD=cpu
ARG PYCOLMAP=pycolmap

# What changes seldom comes first: a change of the code takes none of these layers again.
COPY scripts/setup.sh scripts/
RUN scripts/setup.sh system
COPY requirements.lock ./
RUN scripts/setup.sh torch
RUN scripts/setup.sh packages
COPY pyproject.toml LICENSE README.md ./
COPY api api
COPY bench bench
COPY cli cli
COPY core core
COPY migrations migrations
COPY store store
COPY worker worker
RUN scripts/setup.sh project

# A named volume takes over the owner of the folder that it covers.
RUN mkdir /data /artifacts && chown bladeatlas:bladeatlas /data /artifacts
USER bladeatlas
# The root is read-only where docker-compose.yml runs this: what is compiled at run time is kept with the data.
ENV PATH=/app/.venv/bin:$PATH \
    PYTHONDONTWRITEBYTECODE=1 \
    NUMBA_CACHE_DIR=/data/cache/numba \
    BLADEATLAS_DATA_DIR=/data
VOLUME /data
EXPOSE 8000
CMD ["bladeatlas", "serve", "--host", "0.0.0.0", "--port", "8000"]
