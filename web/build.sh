#!/usr/bin/env bash
# Builds the playground into web/dist: bmod as WebAssembly, then the page. Installs what it needs (the Rust target by rustup, the
# packages of package-lock.json by npm). Any file server can serve the folder, under any path; every file is there compressed too.
# usage: [DRAFT=1] web/build.sh
set -euo pipefail
cd "$(dirname "$0")"

rustup target list --installed | grep -qx wasm32-wasip1 || rustup target add wasm32-wasip1
[ node_modules/.package-lock.json -nt package-lock.json ] || npm ci --no-audit --no-fund --silent

# faer-traits 0.24.0 does not compile where addresses have 32 bits: a copy without the two lines that forbid indices of 64 bits.
version=0.24.0
if [ ! -e target/faer-traits-$version/Cargo.toml ]; then
  cargo fetch --quiet --manifest-path ../Cargo.toml
  mkdir -p target
  cp -r "${CARGO_HOME:-$HOME/.cargo}"/registry/src/*/faer-traits-$version target/
  sed -i -e 's/^#\[cfg(any(target_pointer_width = "64"))\]$//' -e '/core::assert!(i64::BITS <= usize::BITS);/d' \
    target/faer-traits-$version/src/lib.rs
fi

# A draft compiles sooner and runs slower: for tests.
draft=()
if [ -n "${DRAFT:-}" ]; then
  draft=(--config profile.release.package.bmod.opt-level=1 --config profile.release.package.bmod.codegen-units=16)
fi
# A deeply nested text needs more stack than the usual megabyte.
CARGO_TARGET_DIR=$PWD/target/cargo RUSTFLAGS="-Clink-arg=-zstack-size=33554432 -Ctarget-feature=+simd128" \
  cargo build --release --manifest-path wasm/Cargo.toml --target wasm32-wasip1 ${draft[@]+"${draft[@]}"}
cp target/cargo/wasm32-wasip1/release/bmod_wasm.wasm target/bmod.wasm

node_modules/.bin/tsc
node_modules/.bin/vite build --logLevel warn
node compress.mjs
