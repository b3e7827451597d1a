#!/usr/bin/env bash
# setup_venv.sh VENV REQUIREMENT [CONSTRAINTS]: create VENV if necessary and install REQUIREMENT ('.' or '.[dev]',
# editable) at the versions of CONSTRAINTS. MIN_PYTHON requires a newer Python than 3.11.
set -eu
venv=$1
requirement=$2
constraints=${3:-requirements/constraints.txt}
here=$(cd "$(dirname "$0")" && pwd)

if ! "$venv/bin/python" -c '' 2>/dev/null; then
    python=$("$here/find_python.sh" "${MIN_PYTHON:-3.11}")
    echo "Creating $venv with $("$python" --version) ($python)"
    if ! "$python" -m venv --clear "$venv"; then
        echo "$python cannot make virtual environments; on Debian and Ubuntu: apt-get install python3-venv" >&2
        exit 1
    fi
fi
export PIP_DISABLE_PIP_VERSION_CHECK=1
echo "Installing $requirement into $venv; the first time takes a few minutes"
# The build tool is pinned as well, hence no isolated build environment.
"$venv/bin/python" -m pip install -qq -c "$constraints" setuptools
"$venv/bin/python" -m pip install -qq --no-build-isolation -c "$constraints" -e "$requirement"
