#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# Runs `pip install` in a virtual environment, shows its progress, and reports the cause of a failure. Its output is in a file.
# usage: install.sh VENV PIP_INSTALL_ARGUMENTS...
set -eu

venv=$1
shift
log=$venv/.made/pip.log
period=${PROGRESS_PERIOD_S:-10}

progress() { # one line about the progress of pip
    if grep -q '^Installing collected packages' "$log"; then
        echo "unpacking: $(du -sm "$venv" | cut -f 1) MB in $venv so far"
    elif tail -n 1 "$log" | grep -q 'Retrying'; then
        echo "no response from the network; pip retries"
    elif tail -n 1 "$log" | grep -Eq '^ *(Building|Preparing|Installing build|Getting requirements)'; then
        echo "building the package and its compiled core"
    elif ! grep -q '^Collecting ' "$log"; then
        echo "starting pip"
    else
        echo "$(grep -c '^Collecting ' "$log" || true) packages downloaded, now $(sed -n 's/^Collecting \([^ ]*\).*/\1/p' "$log" | tail -n 1)"
    fi
}

show_progress() {
    # Without the redirection, sleep would keep the terminal or pipe open after this shell has ended.
    if [ -t 1 ]; then
        while sleep 1 >/dev/null 2>&1; do printf '\r\033[K  %s' "$(progress)"; done
    else
        while sleep "$period" >/dev/null 2>&1; do echo "  $(progress)"; done
    fi
}

explain() {
    echo "pip failed; its output is in $log" >&2
    if grep -q 'No space left on device' "$log"; then
        echo "The disk is full: $(df -h "$venv" | awk 'NR == 2 { print $4 " are free in " $6 }'), about 2 GB are needed." >&2
    elif grep -Eq 'connection broken|Failed to establish|name resolution|Could not fetch URL|ProxyError|[Tt]imed out|ConnectionError' \
        "$log"; then
        index=$(sed -n 's/^Looking in indexes: //p' "$log" | tail -n 1)
        echo "A package index could not be reached: ${index:-PyPI, the default}." >&2
        sed -n 's/.*\(Temporary failure in name resolution\|Name or service not known\|Connection refused\|Network is unreachable\|CERTIFICATE_VERIFY_FAILED\|[Tt]imed out\).*/  the reason: \1/p' \
            "$log" | sort -u >&2
        cat >&2 <<END
Check the network. Behind a proxy, set https_proxy=http://HOST:PORT; where a mirror is used, name it with PIP_INDEX_URL=...
Then repeat the make command: it continues from here, and pip reuses what it has downloaded.
END
    else
        grep -v 'is ignored: it is' "$log" | tail -n 25 >&2
    fi
}

: >"$log"
show_progress &
heart=$!
trap 'kill "$heart" 2>/dev/null || true' EXIT
failed=0
PYTHONUNBUFFERED=1 "$venv/bin/python" -m pip --disable-pip-version-check install --no-input --progress-bar off "$@" >>"$log" 2>&1 ||
    failed=$?
kill "$heart" 2>/dev/null || true
wait "$heart" 2>/dev/null || true
if [ -t 1 ]; then printf '\r\033[K'; fi
if [ "$failed" -ne 0 ]; then
    explain
    exit 1
fi
