# The one command surface. `make setup` may be run at any time; every other target sets up first.
SHELL := /bin/bash
BIN := .venv/bin
OUT ?= out/demo
RESULT ?= $(OUT)
TRUTH ?= samples/truth

.DEFAULT_GOAL := help
.PHONY: help setup demo web lint docs check test test-long bench-speed bench-accuracy bench-scenes bench-row bench-real bench-inputs bench-service soak mutate versions lock clean

help: ## list the targets
	@grep -E '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed -E 's/:[^#]*## /\t/' | expand -t 18

setup: ## put everything into .venv
	@scripts/setup.sh

demo: setup ## run the whole method on the sample, result in out/demo
	@$(BIN)/bladeatlas run samples/turbine.mp4 samples/turbine.json --out $(OUT)

web: setup ## build the page of results from web/ into core/viewer/bundle (Node from PyPI where there is none)
	@scripts/web.sh

lint: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/check-jsonschema --builtin-schema vendor.compose-spec docker-compose.yml docker-compose.s3.yml

docs: setup ## build the documentation into out/site; a broken link or a page that is in no menu fails
	@NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict

# Unit tests wait for databases and child processes more than they compute, so four files run side by side on two cores:
# in two thirds of the time of two files. Whole deployments and runs on the sample fill the cores and watch the clock: one
# after the other. Compiled modules are kept whatever the environment says, because hundreds of processes of this code are
# started.
UNIT := PYTHONDONTWRITEBYTECODE= $(BIN)/pytest -n 4 --dist loadfile -m

check: lint docs ## lint, types, layers, documentation and the unit tests that are quick (minutes)
	$(UNIT) "not sample and not deployment and not slow"

test: lint docs ## everything, with whole deployments and the runs on the sample
	$(UNIT) "not sample and not deployment"
	PYTHONDONTWRITEBYTECODE= $(BIN)/pytest -m "(sample or deployment) and not long"

test-long: setup ## the walk-through on real jobs, faults at toy jobs, a simulated queue, made clients in Python and TypeScript, second runs and the kill test on the sample (half an hour)
	$(BIN)/pytest -m long

bench-speed: setup ## time the parts of RESULT (default out/demo) beside other programs
	$(BIN)/bladeatlas-bench speed $(RESULT)

bench-accuracy: setup ## score RESULT (default out/demo) against TRUTH (default samples/truth)
	$(BIN)/bladeatlas-bench accuracy $(RESULT) $(TRUTH)

bench-scenes: setup ## render, run and score the suite of scenes (an hour and a half), in out/scenes
	$(BIN)/bladeatlas-bench scenes out/scenes $(SCENES)

bench-row: setup ## find and score the row of blades on true surfaces (half an hour), in out/row; ROW="--result RESULT TRUTH --unknown RESULT" adds results
	$(BIN)/bladeatlas-bench row out/row $(ROW)

bench-real: setup ## run real clips beside COLMAP, from the checkouts in SOURCES (docs/experiments/real-footage.md), in out/real
	$(BIN)/bladeatlas-bench real out/real $(if $(SOURCES),--sources $(SOURCES)) $(REAL)

bench-inputs: setup ## memory and time of a probe of an hour of 1080p, in out/inputs
	$(BIN)/bladeatlas-bench inputs out/inputs

bench-service: setup ## time uploads, downloads, many clients and the queue, attackers for ten minutes, generated requests for five
	$(BIN)/bladeatlas-bench service $(SERVICE)

soak: setup ## jobs through a whole deployment while its processes are killed (hours; SOAK="--toy": a minute)
	$(BIN)/bladeatlas-bench soak out/soak $(SOAK)

mutate: setup ## change the code of AREA (placement, defects, thesis, scene, annotations, points, plan) in 60 places, list what its tests miss
	$(BIN)/bladeatlas-bench mutate $(AREA)

versions: setup ## record the code behind each stage's version (SAME="how results were compared", when they are the same)
	$(BIN)/python -m scripts.stage_versions --same "$(SAME)"

lock: setup ## write requirements.lock and requirements-dev.lock from .venv
	$(BIN)/python -m scripts.locks

clean: ## remove outputs and caches, keep .venv
	rm -rf out build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .import_linter_cache .hypothesis
	find . -name __pycache__ -not -path './.venv/*' -prune -exec rm -rf {} +
