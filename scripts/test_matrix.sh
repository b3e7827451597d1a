#!/usr/bin/env bash
# test_matrix.sh [NAME...]: run a short test suite on every supported jax, each in a separate environment.
# A row whose Python is not on this machine is skipped with a message; a failing row fails the script.
set -eu
cd "$(dirname "$0")/.."

# name | lowest Python | jax | pins. No pins: those of all rows except jax; `lowest`: of every required dependency the lowest
# version that pyproject.toml allows; `newest`, none
ROWS='
lowest |3.11|        |lowest
newest |3.12|        |newest
jax0.9 |3.11|0.9.2   |
jax0.10|3.11|0.10.2  |
jax0.11|3.12|0.11.2  |
jax0.12|3.12|0.12.0.1|
'
# Tests that depend most on JAX: batching rules, FFI, sharding, MJX, random bits, the whole step. No host code.
SUITE='tests/test_package.py tests/test_sharding.py tests/bank/test_bank.py tests/core/test_pytree.py
tests/raycast_render/casting/test_cast.py tests/raycast_render/casting/test_cast_batching.py
tests/raycast_render/casting/test_hit_gradient.py tests/raycast_render/images/test_render.py
tests/physics/test_physics_batch.py tests/physics/test_physics_model.py
tests/audio_jax/auralization/test_impulse_response.py tests/audio_jax/auralization/test_stream.py tests/tasks
tests/adapters/test_gymnasium_adapter.py'

# The common pins without those that a row sets. With the lowest versions only the test tools are pinned.
pins_of() {
    case $1 in
    newest) ;;
    lowest)
        "$(scripts/find_python.sh 3.11)" scripts/lowest_pins.py &&
            grep -E '^(beartype|embreex|hypothesis|pytest|pytest-xdist|setuptools)==' requirements/constraints.txt
        ;;
    *) grep -vE '^(jax|jaxlib|flax)==' requirements/constraints.txt && echo "jax==$2" ;;
    esac
}

run_row() {
    local name=$1 python=$2 jax=$3 kind=$4 venv=.venv-$1
    if ! scripts/find_python.sh "$python" >/dev/null 2>&1; then
        echo "SKIPPED $name: no Python >= $python found"
        return
    fi
    # Steps are chained, because `set -e` is ignored inside `run_row ||`.
    pins_of "$kind" "$jax" >"$pins" &&
        MIN_PYTHON=$python scripts/setup_venv.sh "$venv" '.[test]' "$pins" &&
        echo "== $name: $("$venv/bin/python" -c 'import sys, jax; print("jax", jax.__version__, "Python", sys.version.split()[0])')" &&
        "$venv/bin/python" -m pytest -q -n "${WORKERS:-2}" --dist worksteal -m "not slow" $SUITE
}

pins=$(mktemp)
trap 'rm -f "$pins"' EXIT
failed=''
while IFS='|' read -r name python jax kind; do
    name=${name// /}
    [ -n "$name" ] || continue
    case " ${*:-$name} " in *" $name "*) ;; *) continue ;; esac
    run_row "$name" "${python// /}" "${jax// /}" "${kind// /}" </dev/null || failed="$failed $name"
done <<<"$ROWS"
[ -z "$failed" ] || { echo "FAILED:$failed" >&2; exit 1; }
