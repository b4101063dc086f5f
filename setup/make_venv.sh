#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Makes the virtual environment, unless there is a working one with the Python that was asked for.
# usage: make_venv.sh VENV [PYTHON]
set -eu

venv=$1
asked=${2:-}
stamp=$venv/.made/python

version_of() {
    "$1" -c 'import sys; print("%d.%d" % sys.version_info[:2])' 2>/dev/null || echo none
}

# The programs inside name their folder, so an environment that was moved or copied does not serve.
if [ -e "$stamp" ] && [ "$(cat "$stamp")" = "$(cd "$venv" && pwd -P)" ]; then
    present=$(version_of "$venv/bin/python")
    # An interpreter that was not asked for by name is only the first environment's default.
    wanted=${asked:+$(version_of "$asked")}
    if [ "$present" != none ] && [ "${wanted:-$present}" = "$present" ]; then
        exit 0
    fi
fi

"$(dirname "$0")/check_machine.sh" "${asked:-python3}"
if [ -e "$venv" ]; then
    # One that was not made here may be somebody's work.
    if [ ! -d "$venv/.made" ]; then
        echo "$venv was not made by this Makefile: remove it, or choose another folder with make VENV=..." >&2
        exit 1
    fi
    echo "Making $venv anew."
    rm -rf "$venv"
fi
echo "Making $venv with Python $(version_of "${asked:-python3}")."
mkdir -p "$venv/.made"
"${asked:-python3}" -m venv "$venv"
(cd "$venv" && pwd -P) >"$stamp"
