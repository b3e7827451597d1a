#!/usr/bin/env bash
# Print the first working Python of at least the given version (default 3.11).
# PYTHON=... selects one instead.
set -eu
wanted=${1:-3.11}

fits() {
    "$1" -c "import sys; sys.exit(sys.version_info[:2] < tuple(map(int, '$wanted'.split('.'))))" >/dev/null 2>&1
}

candidates() {
    # The given version first, because the pins are for it. A pyenv shim may exist and still not run.
    local name
    for name in "python$wanted" python3 python python3.11 python3.12 python3.13 python3.14; do
        command -v "$name" || true
    done
    ls -d "${PYENV_ROOT:-$HOME/.pyenv}"/versions/3.*/bin/python3 2>/dev/null | sort -V || true
}

if [ -n "${PYTHON:-}" ]; then
    if ! fits "$PYTHON"; then
        found=$("$PYTHON" --version 2>/dev/null) || found='not a program'
        echo "home-mjx needs Python >= $wanted, but PYTHON=$PYTHON is $found." >&2
        exit 1
    fi
    command -v "$PYTHON"
    exit
fi
for candidate in $(candidates); do
    if fits "$candidate"; then
        echo "$candidate"
        exit
    fi
done
found=$(python3 --version 2>/dev/null) || found='missing'
echo "home-mjx needs Python >= $wanted and found none; python3 is $found." >&2
echo "Install one and try again, or name it: make PYTHON=/path/to/python3 ..." >&2
exit 1
