#!/usr/bin/env bash
# Emacs without a screen opens a model, makes a slip, and is told; asks where a name is declared, and renames it.
#   editors/emacs/tests/run.sh [PROGRAM]      PROGRAM: bmod, target/debug/bmod by default
set -euo pipefail
cd "$(dirname "$0")/../../.."
emacs --batch -f package-initialize --eval "(require 'eglot)" > /dev/null 2>&1 || { echo "SKIPPED: there is no Emacs with eglot here"; exit 0; }
export BMOD=${1:-$PWD/target/debug/bmod}
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
cp models/wall.blk models/block_limit.blk models/mechanism.blk "$folder"
timeout 120 emacs --batch -f package-initialize -L "$PWD/editors/emacs" "$folder/wall.blk" -l "$PWD/editors/emacs/tests/check.el"
