#!/usr/bin/env bash
# Writes requirements.lock from what is installed in .venv: exact versions only, no hosts, no paths.
set -euo pipefail
cd "$(dirname "$0")/.."
{
  echo "# Every package of .venv, developer tools included. Written by scripts/lock.sh; installed by scripts/setup.sh."
  .venv/bin/python -m pip freeze --all --exclude bladeatlas --exclude pip | sed -E 's/^(torch==[0-9.]+)\+.*/\1/'
} > requirements.lock.new
if grep -E '(@ |://|torchvision)' requirements.lock.new; then
  echo "lock: the lines above are not plain versions" >&2
  rm requirements.lock.new
  exit 1
fi
mv requirements.lock.new requirements.lock
