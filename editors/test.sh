#!/usr/bin/env bash
# Tests what editors get: Neovim and Emacs with `bmod lsp`, the grammars of VS Code and tree-sitter. What cannot be installed is skipped, and
# that is said; what is there must pass.
# usage: editors/test.sh [PROGRAM]      PROGRAM: bmod, target/debug/bmod by default
set -euo pipefail
cd "$(dirname "$0")"
root=$(cd .. && pwd)
skipped() { echo "SKIPPED: $1"; }

dpkg -s neovim emacs-nox elpa-eglot >/dev/null 2>&1 || (apt-get update -qq && apt-get install -y -qq neovim emacs-nox elpa-eglot) >/dev/null 2>&1 || true
for editor in vim emacs; do
  $editor/tests/run.sh "${1:-$root/target/debug/bmod}" # says itself where there is no such editor
done

# Only what the test needs, in a folder of its own: the client of the extension is not run here.
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cp -r vscode/package.json vscode/package-lock.json vscode/syntaxes vscode/tests "$folder"
if (cd "$folder" && npm ci --no-audit --no-fund --silent); then
  (cd "$folder" && npm test)
else
  skipped "npm cannot install vscode-tmgrammar-test"
fi

tools=$root/target/tools
PATH=$tools/bin:$PATH
if command -v tree-sitter >/dev/null ||
  cargo install --quiet --debug --locked --version 0.27.1 --no-default-features --root "$tools" tree-sitter-cli; then
  tree-sitter-bmod/test.sh
else
  skipped "cargo cannot install tree-sitter-cli"
fi
