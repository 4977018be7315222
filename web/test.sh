#!/usr/bin/env bash
# Tests the playground in Debian's Chromium: builds it, builds the command line if BMOD does not name one, installs Chromium.
# usage: web/test.sh [options of node --test]
set -euo pipefail
cd "$(dirname "$0")"

if ! command -v chromium >/dev/null; then
  apt-get update -qq && apt-get install -y -qq chromium
fi
DRAFT=${DRAFT-1} ./build.sh
if [ -z "${BMOD:-}" ]; then
  (cd .. && cargo build --quiet)
  export BMOD=$PWD/../target/debug/bmod
fi
node --test --test-concurrency=1 "$@" tests/*.test.mjs
