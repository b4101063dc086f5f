#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Says everything at once that this machine lacks for building the environment. It installs nothing.
# usage: check_machine.sh PYTHON
set -u

python=$1
problems=0
packages_debian=""
packages_fedora=""

refuse() {
    echo "  - $1" >&2
    problems=$((problems + 1))
}

lacks() { # what, the package in Debian and Ubuntu, the package in Fedora
    refuse "$1"
    packages_debian="$packages_debian $2"
    packages_fedora="$packages_fedora $3"
}

ask_python() {
    "$python" -c "$1" 2>/dev/null
}

compiles() { # compiler, language
    object=$(mktemp) && echo 'int main() { return 0; }' | "$1" -x "$2" - -o "$object" >/dev/null 2>&1
    result=$?
    rm -f "$object"
    return $result
}

# Python.h includes others, which may be elsewhere: only a compiler tells whether all of them are there.
has_headers() {
    folder=$(ask_python 'import sysconfig; print(sysconfig.get_path("include"))')
    [ -e "$folder/Python.h" ] || return 1
    ! compiles "${CC:-cc}" c || echo '#include <Python.h>' | "${CC:-cc}" "-I$folder" -fsyntax-only -x c - >/dev/null 2>&1
}

if [ "$(uname -s)-$(uname -m)" != Linux-x86_64 ]; then
    refuse "This is $(uname -s) on $(uname -m). The wheels of ROS 2 Jazzy exist for x86-64 Linux only:
    here, use an installed ROS 2 Jazzy with colcon, or a container."
fi

if version=$(ask_python 'import sys; print("%d.%d" % sys.version_info[:2])'); then
    case $version in
        3.10 | 3.11 | 3.12 | 3.13 | 3.14)
            if ! ask_python 'import ensurepip, venv'; then
                lacks "Python $version has no venv module that works." "python$version-venv" "python3-pip"
            fi
            if ! has_headers; then
                lacks "The header files of Python $version are missing, or some of them." "python$version-dev" "python$version-devel"
            fi
            supported='import platform as p, sys, sysconfig as s
version = [int(part) for part in p.libc_ver()[1].split(".")[:2]] if p.libc_ver()[0] == "glibc" else [0]
ordinary = sys.implementation.name == "cpython" and sys.maxsize > 2**32 and not s.get_config_var("Py_GIL_DISABLED")
raise SystemExit(not (ordinary and version >= [2, 28]))'
            if ! ask_python "$supported"; then
                refuse "$python does not fit the wheels: they need 64-bit CPython, with its lock, and glibc 2.28 or newer."
            fi
            ;;
        *) refuse "$python is Python $version; 3.10 to 3.14 are supported. To name another one: make PYTHON=python3.12 ..." ;;
    esac
else
    # A shim of pyenv or asdf says here that no version is active that has the command.
    reason=$("$python" -c 'pass' 2>&1 | sed '/^$/d; s/^/      /')
    lacks "$python does not run${reason:+, and says:
$reason
   } Python 3.10 to 3.14 is needed; to name one: make PYTHON=python3.12 ..." "python3-dev python3-venv" python3-devel
fi

if ! compiles "${CC:-cc}" c; then
    lacks "There is no working C compiler (${CC:-cc})." build-essential gcc
fi
if ! compiles "${CXX:-c++}" c++; then
    lacks "There is no working C++ compiler (${CXX:-c++}); half of what rosidl generates is C++." build-essential gcc-c++
fi

list() {
    printf '%s\n' "$@" | sort -u | tr '\n' ' '
}

if [ "$problems" -gt 0 ]; then
    echo "Nothing was installed: the above has to be put right first." >&2
    if [ -n "$packages_debian" ]; then
        # The lists are split into words on purpose.
        # shellcheck disable=SC2086
        {
            echo "  Debian, Ubuntu: sudo apt install $(list $packages_debian)"
            echo "  Fedora:         sudo dnf install $(list $packages_fedora)"
        } >&2
    fi
    exit 1
fi
