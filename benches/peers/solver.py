"""Factor and solve by rmpm and by other sparse solvers: same matrix, same minute, one thread, solve included.

The bench `solver` of this repository writes the matrix and times itself when asked; the peers take turns with it.
CPU time of the thread, best of all repeats. A peer that is not installed is named and left out.
"""

import os

for name in ("MKL_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ[name] = "1"

import argparse
import ctypes
import json
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spl

ROOT = Path(__file__).resolve().parents[2]
SIZES = [(90, 20), (180, 45), (360, 90), (720, 180)]
TURNS, REPEATS = 4, 5


def read(path):
    """Matrix (CSC) and right side as the bench writes them."""
    data = path.read_bytes()
    n, values = np.frombuffer(data, "<u8", 2).astype(int)
    at = 16
    pointers = np.frombuffer(data, "<u4", n + 1, at)
    rows = np.frombuffer(data, "<u4", values, at := at + 4 * (n + 1))
    entries = np.frombuffer(data, "<f8", values, at := at + 4 * values)
    rhs = np.frombuffer(data, "<f8", n, at + 8 * values)
    return sp.csc_matrix((entries, rows.astype(np.int32), pointers.astype(np.int32)), (n, n)), rhs.copy()


class Pardiso:
    """MKL PARDISO: phase 11 once, then 22 and 33; L L^T of the upper triangle, or LU."""

    def __init__(self, matrix, rhs, symmetric):
        from pypardiso import PyPardisoSolver

        self.solver = PyPardisoSolver(mtype=2 if symmetric else 11)
        rows = sp.triu(matrix, format="csr") if symmetric else matrix.tocsr()
        rows.sort_indices()
        n = rows.shape[0]
        self.arrays = [rows.data, (rows.indptr + 1).astype(np.int32), (rows.indices + 1).astype(np.int32)]
        self.rhs, self.x = rhs.copy(), np.zeros(n)
        self.solver._mkl_pardiso.argtypes = None
        real, whole = (lambda a: a.ctypes.data_as(ctypes.c_void_p)), (lambda i: ctypes.byref(ctypes.c_int32(i)))
        self.error = ctypes.c_int32(0)
        parameters = self.parameters = np.zeros(64, np.int32)
        parameters[0], parameters[1] = 1, 2
        parameters[9] = 8 if symmetric else 13
        parameters[10] = parameters[12] = 0 if symmetric else 1
        kind = whole(2 if symmetric else 11)
        head = [real(self.solver.pt), whole(1), whole(1), kind]
        tail = [whole(n)] + [real(a) for a in self.arrays]
        tail += [real(np.zeros(n, np.int32)), whole(1), real(parameters), whole(0)]
        tail += [real(self.rhs), real(self.x), ctypes.byref(self.error)]
        self.call = lambda phase: self.solver._mkl_pardiso(*head, whole(phase), *tail)
        self.do(11)

    def do(self, phase):
        self.call(phase)
        if self.error.value:
            raise RuntimeError(f"PARDISO phase {phase}: error {self.error.value}")

    def run(self):
        self.do(22)
        self.do(33)
        return self.x

    def close(self):
        self.do(-1)


class Cholmod:
    """CHOLMOD as CVXOPT carries it: supernodal L L^T by its own choice of order; analysis once."""

    def __init__(self, matrix, rhs, symmetric):
        from cvxopt import cholmod

        if not symmetric:
            raise LookupError("symmetric systems only")
        cholmod.options["supernodal"] = 2
        self.cholmod, self.rhs = cholmod, rhs
        self.matrix = tripled(sp.tril(matrix))
        self.factor = cholmod.symbolic(self.matrix)

    def run(self):
        from cvxopt import matrix

        self.cholmod.numeric(self.matrix, self.factor)
        x = matrix(self.rhs)
        self.cholmod.solve(self.factor, x)
        return np.array(x).ravel()

    def close(self):
        pass


class Umfpack:
    """UMFPACK as CVXOPT carries it; analysis once."""

    def __init__(self, matrix, rhs, symmetric):
        from cvxopt import umfpack

        self.umfpack, self.rhs = umfpack, rhs
        self.matrix = tripled(matrix)
        self.analysis = umfpack.symbolic(self.matrix)

    def run(self):
        from cvxopt import matrix

        x = matrix(self.rhs)
        self.umfpack.solve(self.matrix, self.umfpack.numeric(self.matrix, self.analysis), x)
        return np.array(x).ravel()

    def close(self):
        pass


def tripled(entries):
    """The sparse matrix of CVXOPT with these entries."""
    from cvxopt import spmatrix

    entries = entries.tocoo()
    entries.eliminate_zeros()
    return spmatrix(entries.data, entries.row.astype(int), entries.col.astype(int), entries.shape)


class SuperLu:
    """SuperLU of SciPy, which orders the columns anew each time."""

    def __init__(self, matrix, rhs, symmetric):
        how = {"permc_spec": "MMD_AT_PLUS_A", "options": {"SymmetricMode": True}, "diag_pivot_thresh": 0.0}
        self.matrix, self.rhs, self.how = matrix, rhs, how if symmetric else {"permc_spec": "COLAMD"}

    def run(self):
        return spl.splu(self.matrix, **self.how).solve(self.rhs)

    def close(self):
        pass


PEERS = {"PARDISO": Pardiso, "CHOLMOD": Cholmod, "UMFPACK": Umfpack, "SuperLU": SuperLu}


def milliseconds(peer, repeats):
    best = np.inf
    for _ in range(repeats):
        start = time.thread_time()
        peer.run()
        best = min(best, 1e3 * (time.thread_time() - start))
    return best


class Bench:
    """This repository's side."""

    def __init__(self, folder, program):
        cargo = ["cargo", "bench", "--quiet", "--bench", "solver", "--"]
        command = ([program] if program else cargo) + ["--peer", folder]
        self.process = subprocess.Popen(command, cwd=ROOT, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def best(self, cells, kind, repeats):
        print(*cells, kind, repeats, file=self.process.stdin, flush=True)
        return float(self.process.stdout.readline())

    def close(self):
        self.process.stdin.close()
        self.process.wait()


def compare(bench, folder, cells, kind, names, turns):
    ours = bench.best(cells, kind, 1)
    matrix, rhs = read(Path(folder) / "matrix.bin")
    peers, times = {}, {}
    for name in names:
        try:
            peer = PEERS[name](matrix, rhs, kind == "symmetric")
            residual = np.linalg.norm(rhs - matrix @ peer.run()) / np.linalg.norm(rhs)
            if not residual < 1e-8:
                raise RuntimeError(f"residual {residual:.1e}")
            peers[name], times[name] = peer, np.inf
        except (ImportError, LookupError, RuntimeError) as why:
            print(f"  {name} left out: {why}")
    for _ in range(turns):
        ours = min(ours, bench.best(cells, kind, REPEATS))
        for name, peer in peers.items():
            times[name] = min(times[name], milliseconds(peer, 1 if name == "SuperLU" else REPEATS))
    for peer in peers.values():
        peer.close()
    return ours, times


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", nargs="*", default=list(PEERS), help="peers to ask")
    parser.add_argument("--sizes", type=int, default=len(SIZES), help="how many of the four sizes")
    parser.add_argument("--symmetric", action="store_true", help="leave the unsymmetric systems out")
    parser.add_argument("--turns", type=int, default=TURNS)
    parser.add_argument("--program", help="the bench `solver`, built before; else cargo builds it")
    parser.add_argument("--json", help="file to leave the figures in")
    args = parser.parse_args()
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(folder, args.program)
        for kind in ["symmetric"] if args.symmetric else ["symmetric", "slipping"]:
            print(f"{kind}: factor and solve, ms, best of {args.turns * REPEATS} (rmpm / peer)")
            for cells in SIZES[: args.sizes]:
                ours, times = compare(bench, folder, cells, kind, args.only, args.turns)
                said = "".join(f"   {name} {ms:.2f} ({ours / ms:.2f})" for name, ms in times.items())
                print(f"  {cells[0] * cells[1]:>7} cells   rmpm {ours:.2f}{said}", flush=True)
                rows.append({"kind": kind, "cells": cells[0] * cells[1], "rmpm": ours, **times})
        bench.close()
    if args.json:
        Path(args.json).write_text(json.dumps(rows, indent=1))


if __name__ == "__main__":
    main()
