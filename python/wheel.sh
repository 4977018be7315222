#!/usr/bin/env bash
# Builds the wheel that is given to others: for any Linux since glibc 2.17, with HiGHS in it. Needs Rust and Python; cmake and libclang
# come from Debian, maturin and zig (the linker and the C++ compiler) from PyPI into target/wheel-tools.
# usage: python/wheel.sh [options of maturin]
set -euo pipefail
cd "$(dirname "$0")/.."

if ! command -v cmake >/dev/null || ! ls /usr/lib/llvm-*/lib/libclang*.so* >/dev/null 2>&1; then
  apt-get update -qq && apt-get install -y -qq cmake libclang-dev # for HiGHS
fi
tools=$PWD/target/wheel-tools
[ -x "$tools/bin/maturin" ] || python3 -m venv "$tools"
"$tools/bin/pip" install --quiet 'maturin[zig]>=1.9,<2'
export PATH=$tools/bin:$PATH
maturin build --release --zig --compatibility manylinux_2_17 --features highs --out target/wheels "$@"
ls -l target/wheels
