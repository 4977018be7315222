#!/usr/bin/env bash
# Copies the grammar into a folder and generates its parser there; what is generated is no part of the project.
# The command line of tree-sitter is installed by cargo if it is not there (its npm package fetches it from elsewhere).
# usage: editors/tree-sitter-bmod/generate.sh FOLDER
set -euo pipefail
cd "$(dirname "$0")"
mkdir -p "$1"
out=$(cd "$1" && pwd)

tools=$(cd ../.. && pwd)/target/tools
PATH=$tools/bin:$PATH
command -v tree-sitter >/dev/null || cargo install --quiet --debug --locked --version 0.27.1 --no-default-features --root "$tools" tree-sitter-cli
cp -r grammar.js words.json tree-sitter.json queries src test "$out"
cd "$out" && tree-sitter generate
