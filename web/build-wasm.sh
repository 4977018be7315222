#!/usr/bin/env bash
# Builds bmod for a page: web/target/bmod.wasm (a WASI reactor). Installs the target with rustup where it is missing.
# usage: web/build-wasm.sh [cargo options]
set -euo pipefail
cd "$(dirname "$0")"
rustup target list --installed | grep -qx wasm32-wasip1 || rustup target add wasm32-wasip1

# A copy of faer-traits without the two lines that forbid indices of 64 bits where addresses have 32.
version=0.24.0
if [ ! -e target/faer-traits-$version/Cargo.toml ]; then
  cargo fetch --quiet --manifest-path ../Cargo.toml
  mkdir -p target
  cp -r "${CARGO_HOME:-$HOME/.cargo}"/registry/src/*/faer-traits-$version target/
  sed -i -e 's/^#\[cfg(any(target_pointer_width = "64"))\]$//' -e '/core::assert!(i64::BITS <= usize::BITS);/d' \
    target/faer-traits-$version/src/lib.rs
fi

export CARGO_TARGET_DIR=$PWD/target/cargo
# A deeply nested text needs more stack than the usual megabyte.
export RUSTFLAGS="-Clink-arg=-zstack-size=33554432 -Ctarget-feature=+simd128"
cargo build --release --manifest-path wasm/Cargo.toml --target wasm32-wasip1 "$@"
cp target/cargo/wasm32-wasip1/release/bmod_wasm.wasm target/bmod.wasm
ls -l target/bmod.wasm
