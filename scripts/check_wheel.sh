#!/usr/bin/env bash
# check_wheel.sh PYTHON: builds the wheel, installs it into an empty environment and uses it from another folder.
set -eu
python=$1
root=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export PIP_DISABLE_PIP_VERSION_CHECK=1

# The time of the last change instead of today's: equal sources give equal wheels.
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git -C "$root" log -1 --format=%ct 2>/dev/null || echo 315532800)}
export SOURCE_DATE_EPOCH

rm -rf "$root/build"  # setuptools would pack what a former build left there
"$python" -m pip wheel -qq --no-deps --no-build-isolation --wheel-dir "$work" "$root"
"$python" -m venv "$work/venv"
"$work/venv/bin/python" -m pip install -qq -c "$root/requirements/constraints.txt" "$work"/*.whl
cd "$work"
venv/bin/python -W error -c 'import home_mjx, pathlib; assert "site-packages" in home_mjx.__file__; print("home_mjx", home_mjx.__version__)'
venv/bin/home-mjx --help >help.txt
venv/bin/home-mjx doctor
venv/bin/home-mjx generate houses --seeds 0:2
venv/bin/home-mjx inspect --dataset houses
venv/bin/home-mjx demo --dataset houses --houses 2 --envs 4 --steps 5
for file in contact_sheet.png report.json; do
    [ -s "demo/$file" ] || { echo "the demo wrote no $file" >&2; exit 1; }
done
