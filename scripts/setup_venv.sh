#!/usr/bin/env bash
# setup_venv.sh VENV REQUIREMENT [CONSTRAINTS]: create VENV if necessary and install REQUIREMENT ('.' or '.[dev]',
# editable) at the versions of CONSTRAINTS. MIN_PYTHON requires a newer Python than 3.11.
set -eu -o pipefail
venv=$1
requirement=$2
constraints=${3:-requirements/constraints.txt}
here=$(cd "$(dirname "$0")" && pwd)

# Sizes were measured on x86-64 Linux with Python 3.11.
case $requirement in
    '.[train]') size=", 69 packages: about 0.4 GB to download, 1.2 GB on disk" ;;
    '.[dev]') size=", 134 packages: about 0.6 GB to download, 1.9 GB on disk" ;;
    *) size="" ;;
esac

# Print a line for each file of at least 10 MB that pip fetches, and one when it begins to install them.
show_phases() {
    local line names
    while IFS= read -r line; do
        case $line in
            *"Downloading "*" ("[0-9][0-9]*" MB)"*)
                line=${line##*Downloading }
                echo "  downloading ${line##*/}"
                ;;
            "Installing collected packages: "*)
                IFS=, read -ra names <<<"$line"
                echo "  unpacking ${#names[@]} packages"
                ;;
        esac
    done
}

echo "Installing $requirement with its dependencies into $venv$size"
if ! "$venv/bin/python" -c '' 2>/dev/null; then
    python=$("$here/find_python.sh" "${MIN_PYTHON:-3.11}")
    echo "1/3 creating $venv with $("$python" --version) ($python)"
    if ! "$python" -m venv --clear "$venv"; then
        echo "$python cannot make virtual environments; on Debian and Ubuntu: apt-get install python3-venv" >&2
        exit 1
    fi
fi
export PIP_DISABLE_PIP_VERSION_CHECK=1
# The build tool is pinned as well, hence no isolated build environment.
echo "2/3 installing the build tool"
"$venv/bin/python" -m pip install -qq -c "$constraints" setuptools
echo "3/3 installing the packages of $constraints that are needed"
"$venv/bin/python" -m pip install --progress-bar off --no-build-isolation -c "$constraints" -e "$requirement" |
    show_phases
echo "Installed"
