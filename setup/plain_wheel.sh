#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds the wheel without the compiled core, which installs on every platform: arm64, macOS and Pyodide too.
# The Python needs setuptools and wheel. Nothing is left in the source tree.
# usage: plain_wheel.sh PYTHON FOLDER
set -eu

mkdir -p "$2"
folder=$(cd "$2" && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$(dirname "$0")/.."
CONTACT_DYNAMICS_PLAIN=1 "$1" setup.py -q build --build-base "$work/build" egg_info --egg-base "$work" \
    bdist_wheel --bdist-dir "$work/bdist" --dist-dir "$folder" >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }
