"""Explicit steps a CPU second by rmpm and by one loop written for Numba and for Taichi, one thread.

The loop is the plainest scheme on the paper's slope at once under gravity: USL, Jaumann rate, von Mises with softening,
bilinear functions, fixed base, smooth left side. rmpm does more in a step: MUSL, friction with separation, the control of
the time step, sorting, books. Million particle-steps a CPU second, best of the repeats.
"""

import os

for name in ("OMP_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[name] = "1"

import argparse
import subprocess
import time
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
CELL, COLUMNS, ROWS = 0.25, 240, 28
YOUNG, POISSON, DENSITY, GRAVITY = 1000.0, 0.33, 20.0 / 9.81, 9.81
PEAK, RESIDUAL, SOFTENING = 20.0, 4.0, -50.0
SHEAR = YOUNG / (2 * (1 + POISSON))
LAME = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
DT = 0.25 * CELL / np.sqrt((LAME + 2 * SHEAR) / DENSITY)
FLOOR = 0.05 * DENSITY * CELL * CELL
REPEATS, STEPS = 5, 60


def slope():
    """Two by two Gauss positions of the 1810 cells that the slope touches."""
    g = 0.5 / np.sqrt(3)
    points = []
    for j in range(20):
        for i in range(100 - j):
            for b in (-g, g):
                for a in (-g, g):
                    points.append([(i + 0.5 + a) * CELL, (j + 0.5 + b) * CELL])
    return np.array(points)


def kernels(jit, Array=None, Number=None):
    """The three passes of a step over points in columns, as functions that `jit` compiles; Taichi wants the types."""

    @jit
    def scatter(x: Array, v: Array, stress: Array, volume: Array, mass: Number, node: Array):
        # node: mass, momentum, force; reached through the lower left node of a point
        for n in range(node.shape[0]):
            for k in range(5):
                node[n, k] = 0.0
        for p in range(x.shape[0]):
            sx, sy = x[p, 0] / CELL, x[p, 1] / CELL
            i, j = int(sx), int(sy)
            fx, fy = sx - i, sy - j
            for b in range(2):
                wy = fy if b == 1 else 1.0 - fy
                dy = 1.0 if b == 1 else -1.0
                for a in range(2):
                    wx = fx if a == 1 else 1.0 - fx
                    dx = 1.0 if a == 1 else -1.0
                    w, gx, gy = wx * wy, dx * wy / CELL, dy * wx / CELL
                    n = i + a + (j + b) * (COLUMNS + 1)
                    node[n, 0] += w * mass
                    node[n, 1] += w * mass * v[p, 0]
                    node[n, 2] += w * mass * v[p, 1]
                    node[n, 3] -= volume[p] * (stress[p, 0] * gx + stress[p, 3] * gy)
                    node[n, 4] -= volume[p] * (stress[p, 3] * gx + stress[p, 1] * gy)

    @jit
    def move(node: Array):
        # momenta become new velocities, forces increments of velocity
        for n in range(node.shape[0]):
            m = node[n, 0]
            if m > 0.0:
                m = max(m, FLOOR)  # light nodes fly off with USL
                ax, ay = node[n, 3] / m, node[n, 4] / m - GRAVITY
                vx, vy = node[n, 1] / m, node[n, 2] / m
                column = n % (COLUMNS + 1)
                if n < COLUMNS + 1:
                    ax, ay = -vx / DT, -vy / DT
                elif column == 0:
                    ax = -vx / DT
                node[n, 1], node[n, 2] = vx + DT * ax, vy + DT * ay
                node[n, 3], node[n, 4] = DT * ax, DT * ay

    @jit
    def gather(x: Array, v: Array, stress: Array, plastic: Array, volume: Array, node: Array):
        for p in range(x.shape[0]):
            sx, sy = x[p, 0] / CELL, x[p, 1] / CELL
            i, j = int(sx), int(sy)
            fx, fy = sx - i, sy - j
            ux, uy, ax, ay, lxx, lxy, lyx, lyy = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
            for b in range(2):
                wy = fy if b == 1 else 1.0 - fy
                dy = 1.0 if b == 1 else -1.0
                for a in range(2):
                    wx = fx if a == 1 else 1.0 - fx
                    dx = 1.0 if a == 1 else -1.0
                    w, gx, gy = wx * wy, dx * wy / CELL, dy * wx / CELL
                    n = i + a + (j + b) * (COLUMNS + 1)
                    ux += w * node[n, 1]
                    uy += w * node[n, 2]
                    ax += w * node[n, 3]
                    ay += w * node[n, 4]
                    lxx += gx * node[n, 1]
                    lxy += gy * node[n, 1]
                    lyx += gx * node[n, 2]
                    lyy += gy * node[n, 2]
            v[p, 0] += ax
            v[p, 1] += ay
            x[p, 0] += DT * ux
            x[p, 1] += DT * uy
            exx, eyy, exy, spin = DT * lxx, DT * lyy, 0.5 * DT * (lxy + lyx), 0.5 * DT * (lxy - lyx)
            s0, s1, s2, s3 = stress[p, 0], stress[p, 1], stress[p, 2], stress[p, 3]
            trace = LAME * (exx + eyy)
            t0 = s0 + trace + 2 * SHEAR * exx + 2 * spin * s3
            t1 = s1 + trace + 2 * SHEAR * eyy - 2 * spin * s3
            t2 = s2 + trace
            t3 = s3 + 2 * SHEAR * exy + spin * (s1 - s0)
            mean = (t0 + t1 + t2) / 3
            d0, d1, d2 = t0 - mean, t1 - mean, t2 - mean
            q = (1.5 * (d0 * d0 + d1 * d1 + d2 * d2) + 3 * t3 * t3) ** 0.5
            strength = max(PEAK + SOFTENING * plastic[p], RESIDUAL) * 1.7320508075688772
            if q > strength:
                slope = 1.7320508075688772 * SOFTENING if strength > RESIDUAL * 1.7320508075688773 else 0.0
                strain = (q - strength) / (3 * SHEAR + slope)
                scale = (q - 3 * SHEAR * strain) / q
                plastic[p] += strain
                d0, d1, d2, t3 = scale * d0, scale * d1, scale * d2, scale * t3
            stress[p, 0], stress[p, 1], stress[p, 2], stress[p, 3] = mean + d0, mean + d1, mean + d2, t3
            volume[p] *= 1 + exx + eyy

    return scatter, move, gather


class Loop:
    """The three passes on arrays."""

    def __init__(self, passes, array):
        points = slope()
        n = len(points)
        self.passes, self.points = passes, n
        self.x, self.v, self.stress = array(points), array(np.zeros((n, 2))), array(np.zeros((n, 4)))
        self.plastic, self.volume = array(np.zeros(n)), array(np.full(n, CELL * CELL / 4))
        self.node = array(np.zeros(((COLUMNS + 1) * (ROWS + 1), 5)))
        self.advance(2)

    def advance(self, steps):
        scatter, move, gather = self.passes
        for _ in range(steps):
            scatter(self.x, self.v, self.stress, self.volume, DENSITY * CELL * CELL / 4, self.node)
            move(self.node)
            gather(self.x, self.v, self.stress, self.plastic, self.volume, self.node)


def numba():
    from numba import njit

    return Loop(kernels(njit(fastmath=True, error_model="numpy")), np.copy)


def taichi():
    import taichi as ti

    ti.init(arch=ti.cpu, cpu_max_num_threads=1, default_fp=ti.f64, log_level=ti.ERROR)

    def array(values):
        out = ti.ndarray(ti.f64, values.shape)
        out.from_numpy(values)
        return out

    return Loop(kernels(ti.kernel, ti.types.ndarray(), ti.f64), array)


def rate(loop):
    best = 0.0
    for _ in range(REPEATS):
        start = time.process_time()
        loop.advance(STEPS)
        best = max(best, 1e-6 * STEPS * loop.points / (time.process_time() - start))
    x = loop.x if isinstance(loop.x, np.ndarray) else loop.x.to_numpy()
    assert np.isfinite(x).all() and x[:, 1].mean() < slope()[:, 1].mean(), "it does not fall"
    return best


def ours(program, law):
    cargo = ["cargo", "bench", "--quiet", "--bench", "speed", "--"]
    command = ([program] if program else cargo) + ["--profile", law, "coarse", "1000"]
    runs = (subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout for _ in range(REPEATS))
    return max(float(text.split()[0]) for text in runs)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", help="the bench `speed`, built before; else cargo builds it")
    args = parser.parse_args()
    rates = {f"rmpm, {law}": ours(args.program, law) for law in ("rate", "hencky")}
    for name, make in {"Numba": numba, "Taichi": taichi}.items():
        try:
            rates[name] = rate(make())
        except ImportError as why:
            print(f"{name} left out: {why}")
    print("million particle-steps a CPU second, 7,240 points")
    for name, value in rates.items():
        print(f"  {name:<14}{value:8.1f}   rmpm (rate law) / this {rates['rmpm, rate'] / value:.2f}")


if __name__ == "__main__":
    main()
