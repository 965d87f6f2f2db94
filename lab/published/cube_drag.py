#!/usr/bin/env python3
"""Computes the Stokes drag of a cube: the force of a translation and the torque of a rotation.

python3 lab/published/cube_drag.py    needs only Python, takes some minutes

Each panel of the surface has an unknown force. The forces of one octant are solved for, and the
others follow by reflection. The capacity of the cube checks the method: its value is known, 0.6607.
"""
import math

SUBPOINTS = 6
"""Number of points per direction for averages over near panels."""


def panels(count):
    """Returns the panels of an octant: centre, normal axis, and half widths [side lengths]."""
    edges = [0.5 * math.sin(math.pi / 2 * i / count) for i in range(count + 1)]
    middles = [((a + b) / 2, (b - a) / 2) for a, b in zip(edges, edges[1:])]
    found = []
    for normal in range(3):
        for u, du in middles:
            for v, dv in middles:
                centre, half = [0.5] * 3, [0.0] * 3
                first, second = [axis for axis in range(3) if axis != normal]
                centre[first], centre[second] = u, v
                half[first], half[second] = du, dv
                found.append((centre, normal, half))
    return found


class Laplace:
    """The kernel of electrostatics. All components of the unknown are charges."""

    @staticmethod
    def between(d):
        r = math.sqrt(sum(p * p for p in d))
        return [[(i == j) / r for j in range(3)] for i in range(3)]

    @staticmethod
    def on_itself(normal, half):
        along_a, along_b, area, _, _ = parts(normal, half)
        return [[(along_a + along_b) / area * (i == j) for j in range(3)] for i in range(3)]


class Stokes:
    """The Oseen tensor, times 8 pi and the viscosity."""

    @staticmethod
    def between(d):
        r2 = sum(p * p for p in d)
        r = math.sqrt(r2)
        return [[((i == j) + d[i] * d[j] / r2) / r for j in range(3)] for i in range(3)]

    @staticmethod
    def on_itself(normal, half):
        along_a, along_b, area, first, second = parts(normal, half)
        diagonal = [along_a + along_b] * 3
        diagonal[first] += along_a
        diagonal[second] += along_b
        return [[diagonal[i] / area * (i == j) for j in range(3)] for i in range(3)]


def parts(normal, half):
    """Returns the integrals of x² / r³ and y² / r³ over a panel, its area, and its axes."""
    first, second = [axis for axis in range(3) if axis != normal]
    a, b = 2 * half[first], 2 * half[second]
    return 2 * b * math.asinh(a / b), 2 * a * math.asinh(b / a), a * b, first, second


def mean_over(kernel, x, centre, normal, half):
    """Returns the mean of the kernel between a point and a panel."""
    d = [p - q for p, q in zip(x, centre)]
    size = 2 * max(half)
    distance = math.sqrt(sum(p * p for p in d))
    if distance > 4 * size:
        return kernel.between(d)
    n = SUBPOINTS
    steps = [(2 * i + 1) / n - 1 for i in range(n)]
    first, second = [axis for axis in range(3) if axis != normal]
    total = [[0.0] * 3 for _ in range(3)]
    for s in steps:
        for t in steps:
            point = list(d)
            point[first] -= s * half[first]
            point[second] -= t * half[second]
            entries = kernel.between(point)
            for i in range(3):
                for j in range(3):
                    total[i][j] += entries[i][j]
    return [[entry / (n * n) for entry in row] for row in total]


def solve(matrix, right):
    """Solves a linear system by Gaussian elimination with partial pivoting."""
    size = len(right)
    rows = [row + [value] for row, value in zip(matrix, right)]
    for k in range(size):
        pivot = max(range(k, size), key=lambda i: abs(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        top = rows[k]
        for i in range(k + 1, size):
            factor = rows[i][k] / top[k]
            if factor:
                rows[i][k + 1 :] = [p - factor * q for p, q in zip(rows[i][k + 1 :], top[k + 1 :])]
    answer = [0.0] * size
    for k in reversed(range(size)):
        known = sum(p * q for p, q in zip(rows[k][k + 1 : size], answer[k + 1 :]))
        answer[k] = (rows[k][size] - known) / rows[k][k]
    return answer


def forces(kernel, count, velocity, sign):
    """Returns the panels of an octant with their forces, for a velocity of the surface.

    A reflection M turns the force f at x into `sign(M)` M f at M x.
    """
    octant = panels(count)
    mirrors = [[x, y, z] for x in (1, -1) for y in (1, -1) for z in (1, -1)]
    matrix, right = [], []
    for x, _, _ in octant:
        block = [[], [], []]
        for centre, normal, half in octant:
            total = [[0.0] * 3 for _ in range(3)]
            for mirror in mirrors:
                image = [m * c for m, c in zip(mirror, centre)]
                if image == x:
                    entries = kernel.on_itself(normal, half)
                else:
                    entries = mean_over(kernel, x, image, normal, half)
                factor = sign(mirror)
                for i in range(3):
                    for j in range(3):
                        total[i][j] += entries[i][j] * mirror[j] * factor / (8 * math.pi)
            for i in range(3):
                block[i] += total[i]
        matrix += block
        right += velocity(x)
    found = solve(matrix, right)
    return [(centre, found[3 * i : 3 * i + 3]) for i, (centre, _, _) in enumerate(octant)]


def along_z(kernel, count):
    """Returns the force for unit velocity along z, divided by the viscosity and the side."""
    found = forces(kernel, count, lambda x: [0.0, 0.0, 1.0], lambda mirror: mirror[2])
    return 8 * sum(f[2] for _, f in found)


def about_z(count):
    """Returns the torque for unit rotation about z, divided by the viscosity and the cubed side."""
    found = forces(Stokes, count, lambda x: [-x[1], x[0], 0.0], lambda m: m[0] * m[1])
    return 8 * sum(x[0] * f[1] - x[1] * f[0] for x, f in found)


print("panels per edge   capacity / a   radius / a   torque / (eta a^3 omega)")
rows = []
for count in (4, 6, 8):
    capacity = along_z(Laplace, count) / (8 * math.pi)
    rows.append([capacity, along_z(Stokes, count) / (6 * math.pi), about_z(count)])
    print("{:15}   {:12.5f}   {:10.5f}   {:.5f}".format(2 * count, *rows[-1]), flush=True)
# The error decreases with the square of the number of panels per edge.
limit = [(fine * 64 - coarse * 36) / 28 for coarse, fine in zip(rows[1], rows[2])]
print("{:>15}   {:12.4f}   {:10.4f}   {:.3f}".format("limit", *limit))
