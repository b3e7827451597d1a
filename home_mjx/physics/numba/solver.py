"""Exact solver for MuJoCo's convex problem, island by island.

The accelerations minimise 1/2 (a - smooth)' M (a - smooth) + sum over rows of 1/2 weight min(0, J a - target)^2.
Newton's method finds the minimum of this piecewise quadratic function. It has converged after a full step that leaves
the set of active rows unchanged. M is diagonal, and bodies that do not touch one another are independent problems.

Sources: E. Todorov, "Convex and analytically-invertible dynamics with contacts and constraints", ICRA 2014; MuJoCo's
documentation, "Computation", section "Constraint solver".
"""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from math import sqrt
from typing import no_type_check

import numpy as np

from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import offset_pointer
from home_mjx.physics.numba.constraint import contact_velocity, edge_value, num_rows
from home_mjx.physics.numba.workspace import NEWTON_STEPS, NUM_CONTACTS, num_contact_dofs

LINE_SEARCH_TOLERANCE = 1e-9  # line-search tolerance: final slope of the cost over that at its start
MAX_LINE_STEPS = 40  # maximum number of line-search iterations
# Newton tolerance: remaining decrease over the cost's scale, the square of a relative error of 1e-11
NEWTON_TOLERANCE = 1e-22
MIN_PIVOT = 1e-12  # minimum Cholesky pivot before its square root [kg] or [kg m^2]

compiled = compile_inner()


@compiled
@no_type_check
def solve(work, numbers):
    """Replace `acc` of awake bodies, the initial guess, by the solution: accelerations with contact forces.

    Bodies without contacts get `smooth`; sleeping ones are unchanged, as is the yaw part of agents with contacts.
    `counts[NEWTON_STEPS]` becomes the number of Newton iterations of all islands. An island that has not converged
    after `numbers.iterations` keeps its last iterate, without a flag.
    """
    work.counts[NEWTON_STEPS] = 0
    _find_islands(work)
    count = work.counts[NUM_CONTACTS]
    for root in range(work.num_dynamic):
        if work.awake[root] and work.island[root] == root:
            members, size = _collect_members(work, root)
            rows = 0
            for n in range(count):
                if work.island[work.first[n]] == root:
                    work.rows[rows] = n
                    rows += 1
            if rows:
                _newton(work, members, rows, size, int(numbers.iterations))
            else:
                for k in range(6):
                    work.acc[6 * root + k] = work.smooth[6 * root + k]


@compiled
@no_type_check
def _find_islands(work):
    """Label each body (`island`) with the lowest index in its island, the awake bodies connected by contacts.

    Static boxes, the floor and sleeping bodies do not connect others; a sleeping body is an island of its own.
    """
    for m in range(work.num_dynamic):
        work.island[m] = m
    for n in range(work.counts[NUM_CONTACTS]):
        if work.second[n] >= 0:
            a, b = _root(work, work.first[n]), _root(work, work.second[n])
            work.island[max(a, b)] = min(a, b)
    for m in range(work.num_dynamic):
        if work.awake[m]:
            work.island[m] = _root(work, m)


@compiled
@no_type_check
def _root(work, m):
    """Follow `island` links from body `m` to the body that links to itself."""
    while work.island[m] != m:
        m = work.island[m]
    return m


@compiled
@no_type_check
def _collect_members(work, root):
    """List an island's awake bodies in `work.members`, assign their offsets; return the numbers of bodies and DoFs.

    They are in ascending order from `root`, the lowest index.
    """
    members, size = 0, 0
    for m in range(root, work.num_dynamic):
        if work.awake[m] and work.island[m] == root:
            work.members[members] = m
            work.offset[m] = size
            members += 1
            size += num_contact_dofs(work, m)
    return members, size


@compiled
@no_type_check
def _newton(work, members, rows, size, iterations):
    """Iterate Newton's method on an island's `acc` until a full step leaves the active rows unchanged or none helps.

    `members`, `rows` and `size` are its numbers of bodies, contacts and DoFs; `iterations` is the maximum. Iterations
    are added to `counts[NEWTON_STEPS]`.
    """
    full = False
    for _ in range(iterations):
        work.counts[NEWTON_STEPS] += 1
        changed = _update_residuals(work, rows)
        if full and not changed:
            return
        _assemble(work, members, rows, size)
        _factorise(work.hessian, size)
        _back_substitute(work.hessian, work.gradient, work.search, size)
        length = _line_search(work, members, rows)
        full = length == 1.0
        for i in range(members):
            m = work.members[i]
            for k in range(num_contact_dofs(work, m)):
                work.acc[6 * m + k] += length * work.search[work.offset[m] + k]
        if length == 0.0:
            return


@compiled
@no_type_check
def _update_residuals(work, rows):
    """Write J a - target and the active (negative) rows of `rows` contacts; return whether the active set changed.

    An island's first result in a physics step has no meaning, since `active` is then of earlier contacts.
    """
    changed = False
    for i in range(rows):
        n = work.rows[i]
        friction = work.friction[n]
        normal, first, second = contact_velocity(work, n, work.acc)
        active = 0
        for row in range(num_rows(friction)):
            value = edge_value(row, friction, normal, first, second) - work.target[4 * n + row]
            work.residual[4 * n + row] = value
            if value < 0:
                active |= 1 << row
        changed |= active != work.active[n]
        work.active[n] = active
    return changed


@compiled
@no_type_check
def _assemble(work, members, rows, size):
    """Assemble the gradient and the lower triangle of the Hessian (`size`, `size`) of an island's cost.

    The island has `members` bodies, listed in `work.members`, and `rows` contacts, listed in `work.rows`. Residuals and
    active rows must be up to date. The upper triangle is not written.
    """
    hessian, gradient = work.hessian, work.gradient
    for i in range(size):
        for j in range(i + 1):
            hessian[size * i + j] = 0.0
    for i in range(members):
        m = work.members[i]
        for k in range(num_contact_dofs(work, m)):
            at = work.offset[m] + k
            hessian[size * at + at] = work.mass[6 * m + k]
            gradient[at] = work.mass[6 * m + k] * (work.acc[6 * m + k] - work.smooth[6 * m + k])
    for i in range(rows):
        n = work.rows[i]
        if work.active[n]:
            _add_contact(work, n, size)


@compiled
@no_type_check
def _add_contact(work, n, size):
    """Add contact `n`'s active rows: forces to the gradient, stiffness to the lower Hessian (`size`, `size`).

    Of two dynamic bodies, `first` must have the lower index, as `find_contacts` orders them.
    """
    weight, friction, active = work.weight[n], work.friction[n], work.active[n]
    f0 = f1 = f2 = w00 = w01 = w02 = w11 = w22 = 0.0
    for row in range(num_rows(friction)):
        if active & (1 << row):
            edge = friction if row % 2 == 0 else -friction
            force = weight * work.residual[4 * n + row]
            f0 += force
            w00 += weight
            if row < 2:
                f1, w01, w11 = f1 + force * edge, w01 + weight * edge, w11 + weight * edge * edge
            else:
                f2, w02, w22 = f2 + force * edge, w02 + weight * edge, w22 + weight * edge * edge
    hessian, gradient = work.hessian, work.gradient
    for side in range(2):
        m = work.first[n] if side == 0 else work.second[n]
        if m < 0:
            continue
        own = offset_pointer(work.jacobian, 36 * n + 18 * side)
        for i in range(num_contact_dofs(work, m)):
            row = work.offset[m] + i
            x, y, z = own[i], own[6 + i], own[12 + i]
            gradient[row] += x * f0 + y * f1 + z * f2
            u, v, w = w00 * x + w01 * y + w02 * z, w01 * x + w11 * y, w02 * x + w22 * z
            # The first body of a contact also comes first in its island, so this fills the lower triangle.
            for other in range(side + 1):
                by = work.first[n] if other == 0 else m
                jacobian = offset_pointer(work.jacobian, 36 * n + 18 * other)
                for j in range(i + 1 if other == side else num_contact_dofs(work, by)):
                    column = work.offset[by] + j
                    hessian[size * row + column] += u * jacobian[j] + v * jacobian[6 + j] + w * jacobian[12 + j]


@compiled
@no_type_check
def _factorise(matrix, size):
    """Replace a symmetric matrix's lower triangle by its Cholesky factor; squared pivots are at least `MIN_PIVOT`.

    An indefinite matrix is not reported. The upper triangle is neither read nor written.
    """
    for j in range(size):
        pivot = matrix[size * j + j]
        for k in range(j):
            pivot -= matrix[size * j + k] * matrix[size * j + k]
        pivot = sqrt(max(pivot, MIN_PIVOT))
        matrix[size * j + j] = pivot
        for i in range(j + 1, size):
            value = matrix[size * i + j]
            for k in range(j):
                value -= matrix[size * i + k] * matrix[size * j + k]
            matrix[size * i + j] = value / pivot


@compiled
@no_type_check
def _back_substitute(factor, gradient, search, size):
    """Write Newton's direction, minus inverse Hessian times gradient, to `search`; `factor` is from `_factorise`."""
    for i in range(size):
        value = -gradient[i]
        for k in range(i):
            value -= factor[size * i + k] * search[k]
        search[i] = value / factor[size * i + i]
    for i in range(size - 1, -1, -1):
        value = search[i]
        for k in range(i + 1, size):
            value -= factor[size * k + i] * search[k]
        search[i] = value / factor[size * i + i]


@compiled
@no_type_check
def _line_search(work, members, rows):
    """Return the step along `search` that minimises the cost; exactly 1 if a full step does, 0 if converged or NaN.

    After `MAX_LINE_STEPS` the last estimate is returned. The island has `members` bodies, listed in `work.members`, and
    `rows` contacts, listed in `work.rows`; `slope` of these is overwritten.
    """
    start, curve, scale = _inertial_derivatives(work, members)
    _write_residual_slopes(work, rows)
    before, _ = _derivatives(work, rows, start, curve, 0.0)
    if not before < -NEWTON_TOLERANCE * scale:
        return 0.0
    low, high, length = 0.0, np.inf, 1.0
    for _ in range(MAX_LINE_STEPS):
        slope, bend = _derivatives(work, rows, start, curve, length)
        if abs(slope) <= -LINE_SEARCH_TOLERANCE * before:
            return length
        if slope < 0:
            low = length
        else:
            high = length
        length -= slope / bend
        if length <= low or length >= high:
            length = (low + high) / 2 if high < np.inf else 2 * low
    return length


@compiled
@no_type_check
def _inertial_derivatives(work, members):
    """Return slope at 0 and curvature of the inertial cost along `search`, and the cost's scale.

    `members` is the number of bodies in `work.members`. The scale, the sum of m (acc² + smooth²), makes the
    convergence test relative.
    """
    start, curve, scale = 0.0, 0.0, 0.0
    for i in range(members):
        m = work.members[i]
        for k in range(num_contact_dofs(work, m)):
            step = work.search[work.offset[m] + k]
            start += work.mass[6 * m + k] * (work.acc[6 * m + k] - work.smooth[6 * m + k]) * step
            curve += work.mass[6 * m + k] * step * step
            guess, free = work.acc[6 * m + k], work.smooth[6 * m + k]
            scale += work.mass[6 * m + k] * (guess * guess + free * free)
    return start, curve, scale


@compiled
@no_type_check
def _write_residual_slopes(work, rows):
    """Write the slopes of the residuals of the `rows` contacts in `work.rows` along `search` to `slope`.

    As in `residual`, these are pyramid edges, see `edge_value`: four elements with friction, else only the first.
    """
    for i in range(rows):
        n = work.rows[i]
        x = y = z = 0.0
        for side in range(2):
            m = work.first[n] if side == 0 else work.second[n]
            if m >= 0:
                jacobian = offset_pointer(work.jacobian, 36 * n + 18 * side)
                for k in range(num_contact_dofs(work, m)):
                    step = work.search[work.offset[m] + k]
                    x, y, z = x + jacobian[k] * step, y + jacobian[6 + k] * step, z + jacobian[12 + k] * step
        friction = work.friction[n]
        for row in range(num_rows(friction)):
            work.slope[4 * n + row] = edge_value(row, friction, x, y, z)


@compiled
@no_type_check
def _derivatives(work, rows, start, curve, length):
    """Return slope and curvature of the cost at `length` along `search`; `start`, `curve`: those of inertia at 0.

    Residuals (at 0) and their slopes, of the `rows` contacts in `work.rows`, must be up to date.
    """
    slope, bend = start + length * curve, curve
    for i in range(rows):
        n = work.rows[i]
        weight = work.weight[n]
        for row in range(num_rows(work.friction[n])):
            rate = work.slope[4 * n + row]
            value = work.residual[4 * n + row] + length * rate
            if value < 0:
                slope += weight * value * rate
                bend += weight * rate * rate
    return slope, bend
