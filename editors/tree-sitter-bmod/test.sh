#!/usr/bin/env bash
# Tests the grammar: its trees and its colours (test/), and that it reads every model of the project without an error, but those
# that are wrong and one with lines that `$else` leaves out and that are no model.
# usage: editors/tree-sitter-bmod/test.sh [more files or folders]
set -euo pipefail
cd "$(dirname "$0")"
root=$(cd ../.. && pwd)
out=$root/target/tree-sitter-bmod
PATH=$root/target/tools/bin:$PATH

./generate.sh "$out"
cd "$out"
tree-sitter test
find "$root/models" "$root/tests/suite" "$root/web/exercises" "$@" \( -name '*.blk' -o -name '*.gms' \) \
  ! -path '*/errors/*' ! -name ifthen_skips.blk >files.txt
tree-sitter parse --quiet --stat --paths files.txt
