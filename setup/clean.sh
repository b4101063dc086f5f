#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Removes what make made in the project's folder, and nothing else that has a similar name.
# usage: clean.sh VENV
set -eu

for venv in "$1" "$1"-matrix/* "$1"-wheels; do
    if [ -d "$venv/.made" ]; then
        echo "removing $venv"
        rm -rf "$venv"
    elif [ -e "$venv" ]; then
        echo "$venv stays: it was not made by this Makefile."
    fi
done
rmdir "$1"-matrix 2>/dev/null || true

# setuptools and the tools of `make test` fill these again.
rm -rf contact_dynamics.egg-info coverage_html site .coverage .hypothesis .mypy_cache .pytest_cache .ruff_cache

# The compiled core, which was built in place.
find contact_dynamics -name '*.cpython-*.so' -delete 2>/dev/null || true

# The name shows that a folder is the demo's, and files in it that only the demo writes.
for run in demo_output/[0-9][0-9][0-9][0-9]-[0-9][0-9]-[0-9][0-9]_*; do
    if [ -e "$run/parameters.yaml" ] && [ -e "$run/toss_publisher.txt" ]; then
        echo "removing $run"
        rm -rf "$run"
    fi
done
if [ -d demo_output ]; then
    rmdir demo_output 2>/dev/null || echo "demo_output stays: something in it was not made by make demo."
fi
for folder in build install log; do
    if [ -e "$folder" ]; then
        echo "$folder stays: make does not make it (colcon does)."
    fi
done
