#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Prints the Pythons of this machine that can make an environment, one a line: version, tab, program.
# A version that is not at hand, or has only shims that do not run, is named on stderr.
# usage: pythons.sh
#   PYTHONS="3.10 3.13"     only these
set -u

works() { # program, version: it runs, is that version, and can make environments
    "$1" -c "import sys, venv, ensurepip; raise SystemExit('%d.%d' % sys.version_info[:2] != '$2')" >/dev/null 2>&1
}

candidates() { # version; the newest release first where a folder holds several
    # Each folder of PATH, because a shim may hide a Python that works.
    printf '%s\n' "$PATH" | tr ':' '\n' | sed "s|\$|/python$1|"
    ls -d "${PYENV_ROOT:-$HOME/.pyenv}/versions/$1".*/bin/"python$1" 2>/dev/null | sort -rV
    printf '%s\n' "/usr/bin/python$1" "/usr/local/bin/python$1"
    ls -d "${UV_PYTHON_INSTALL_DIR:-${XDG_DATA_HOME:-$HOME/.local/share}/uv/python}/cpython-$1".*/bin/"python$1" 2>/dev/null | sort -rV
}

for version in ${PYTHONS:-3.10 3.11 3.12 3.13 3.14}; do
    found=""
    while IFS= read -r program; do
        if [ -z "$found" ] && [ -x "$program" ] && works "$program" "$version"; then
            found=$program
            printf '%s\t%s\n' "$version" "$program"
        fi
    done <<END
$(candidates "$version")
END
    [ -n "$found" ] || echo "NOT AT HAND: Python $version" >&2
done
