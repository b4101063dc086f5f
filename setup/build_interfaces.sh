#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Builds contact_dynamics_interfaces with the rosidl generators of a virtual environment, and installs it there.
# usage: build_interfaces.sh VENV
set -eu

here=$(cd "$(dirname "$0")/.." && pwd -P)
venv=$(cd "$1" && pwd -P)
build=$venv/build/contact_dynamics_interfaces
log=$build/build.log

# The machine's own program if it is new enough, else the one on PyPI.
program() { # name, oldest version that serves, requirement for pip
    found=$("$1" --version 2>/dev/null | sed -n '1s/[^0-9]*\([0-9.]*\).*/\1/p') || found=""
    if [ -n "$found" ] && printf '%s\n%s\n' "$2" "$found" | sort -V -C; then
        command -v "$1"
    else
        [ -x "$venv/bin/$1" ] || "$here/setup/install.sh" "$venv" "$3" >&2
        echo "$venv/bin/$1"
    fi
}

run() {
    if ! "$@" >>"$log" 2>&1; then
        tail -n 40 "$log" >&2
        echo "Building contact_dynamics_interfaces failed; the whole log is $log" >&2
        exit 1
    fi
}

show_progress() { # how far ninja is; sleep must not keep the terminal or pipe open when this shell is gone
    while sleep "${PROGRESS_PERIOD_S:-10}" >/dev/null 2>&1; do
        sed -n 's/^\[\([0-9]*\)\/\([0-9]*\)\] .*/  step \1 of \2/p' "$log" | tail -n 1
    done
}

# 3.21: the property that lists a folder's imported targets (cmake/wheel_paths.cmake).
cmake=$(program cmake 3.21 'cmake>=3.28,<4')
ninja=$(program ninja 1.10 'ninja>=1.11')

echo "Building contact_dynamics_interfaces (a minute or two)."
mkdir -p "$build"
: >"$log"
show_progress &
heart=$!
links=""
trap 'kill "$heart" 2>/dev/null || true; [ -z "$links" ] || rm -r "$links"' EXIT

# ament and the generators do not quote paths. Where a shell would take a path apart, the build sees links with plain names.
case $here$venv in
    *[!A-Za-z0-9_./+@-]*)
        links=$(mktemp -d /tmp/contact_dynamics.XXXXXX)
        ln -s "$here" "$links/package"
        ln -s "$venv" "$links/environment"
        case $cmake in "$venv"/*) cmake=$links/environment/bin/cmake ;; esac
        case $ninja in "$venv"/*) ninja=$links/environment/bin/ninja ;; esac
        here=$links/package
        venv=$links/environment
        # The names of the links are new each time, and CMake refuses a folder that was configured under another name.
        find "$build" -mindepth 1 ! -name build.log ! -name installed.txt -delete
        build=$venv/build/contact_dynamics_interfaces
        ;;
esac

export AMENT_PREFIX_PATH="$venv" CMAKE_PREFIX_PATH="$venv"
run "$cmake" -G Ninja -S "$here/contact_dynamics_interfaces" -B "$build" \
    -DCMAKE_MAKE_PROGRAM="$ninja" \
    -DCMAKE_PROJECT_INCLUDE="$here/cmake/wheel_paths.cmake" \
    -DCMAKE_INSTALL_PREFIX="$venv" \
    -DPython3_EXECUTABLE="$venv/bin/python" \
    -DBUILD_TESTING=OFF
run "$cmake" --build "$build"
# What a former version of the interfaces installed must not stay behind it. The list's names are relative to the environment.
if [ -e "$build/installed.txt" ]; then
    (cd "$venv" && xargs -d '\n' rm -f) <"$build/installed.txt"
fi
run "$cmake" --install "$build"
cut -c $((${#venv} + 2))- "$build/install_manifest.txt" >"$build/installed.txt"
