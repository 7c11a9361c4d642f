#!/usr/bin/env bash
# Writes the passwords that docker-compose.yml mounts, each a random one, into FOLDER (secrets). Those that are there stay.
#
#   scripts/secrets.sh [FOLDER]
set -euo pipefail
folder=${1:-"$(dirname "$0")/../secrets"}
# Others of this machine cannot enter the folder. The files themselves are readable: in a container another user reads them.
mkdir -p -m 700 "$folder"
for name in postgres_password redis_password; do
  [ -s "$folder/$name" ] && continue
  head -c 24 /dev/urandom | base64 | tr -d '\n' > "$folder/$name"
  chmod 644 "$folder/$name"
  printf 'secrets: %s\n' "$folder/$name"
done
