#!/usr/bin/env bash
# check_wheel.sh PYTHON: build the sdist and the wheel, and the wheel again from the sdist, which must be identical;
# then install it into an empty environment and use it from another folder.
set -eu
python=$1
root=$(cd "$(dirname "$0")/.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export PIP_DISABLE_PIP_VERSION_CHECK=1
unset PYTHONPATH  # packages on PYTHONPATH would count as installed

# The time of the last commit, so that equal sources build equal wheels.
SOURCE_DATE_EPOCH=${SOURCE_DATE_EPOCH:-$(git -C "$root" log -1 --format=%ct 2>/dev/null || echo 315532800)}
export SOURCE_DATE_EPOCH

rm -rf "$root/build"  # setuptools would pack files of an earlier build
"$python" -m pip wheel -qq --no-deps --no-build-isolation --wheel-dir "$work" "$root"
# Build from the unpacked sdist, in another folder, at another time: it must be complete, and the bytes equal.
(cd "$root" && "$python" -c 'import sys; from setuptools import build_meta; build_meta.build_sdist(sys.argv[1])' "$work" >/dev/null)
mkdir "$work/source" "$work/again"
tar xzf "$work"/*.tar.gz -C "$work/source" --strip-components 1 --touch
"$python" -m pip wheel -qq --no-deps --no-build-isolation --wheel-dir "$work/again" "$work/source"
cmp "$work"/*.whl "$work/again"/*.whl || { echo "two builds of the wheel differ" >&2; exit 1; }
for folder in tests docs examples scripts benchmarks; do
    [ -d "$work/source/$folder" ] || { echo "the sdist lacks $folder" >&2; exit 1; }
done
[ "${2:-}" != --build-only ] || { echo "equal wheels"; exit 0; }
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
