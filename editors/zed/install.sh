#!/usr/bin/env bash
# Makes the extension for Zed in target/zed: the grammar with its generated parser as a git repository of its own, which Zed
# fetches it from, and the extension with the address of that. Then, in Zed: "zed: install dev extension", and this folder.
# usage: editors/zed/install.sh
set -euo pipefail
cd "$(dirname "$0")"
out=$(cd ../.. && pwd)/target/zed
grammar=$out/tree-sitter-bmod

../tree-sitter-bmod/generate.sh "$grammar"
git -C "$grammar" init --quiet
git -C "$grammar" add --all
git -C "$grammar" -c user.name=bmod -c user.email=bmod@localhost commit --quiet --allow-empty --message "The grammar of bmod, generated"
revision=$(git -C "$grammar" rev-parse HEAD)

rm -rf "$out/bmod" && mkdir -p "$out/bmod"
cp -r Cargo.toml src languages "$out/bmod"
cp "$grammar/queries/highlights.scm" "$out/bmod/languages/bmod/"
sed -e "s|REPOSITORY|file://$grammar|" -e "s|REVISION|$revision|" extension.toml >"$out/bmod/extension.toml"
echo "In Zed: \"zed: install dev extension\", then $out/bmod"
