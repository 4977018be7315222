#!/usr/bin/env bash
# Neovim without a screen opens a model, makes a slip, and is told; asks where a name is declared, and renames it.
#   editors/vim/tests/run.sh [PROGRAM]      PROGRAM: bmod, target/debug/bmod by default
set -euo pipefail
cd "$(dirname "$0")/../../.."
command -v nvim > /dev/null || { echo "SKIPPED: there is no nvim here"; exit 0; }
export BMOD=${1:-$PWD/target/debug/bmod}
folder=$(mktemp -d); trap 'rm -rf "$folder"' EXIT
cp models/wall.blk models/block_limit.blk models/mechanism.blk "$folder"
export XDG_DATA_HOME=$folder XDG_STATE_HOME=$folder XDG_CONFIG_HOME=$folder XDG_CACHE_HOME=$folder
timeout 60 nvim --headless -u NONE --cmd "set rtp^=$PWD/editors/vim" --cmd 'filetype plugin on | syntax on' \
  --cmd "lua require('bmod').command = vim.env.BMOD" "$folder/wall.blk" -c "luafile editors/vim/tests/check.lua"
