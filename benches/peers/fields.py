"""A realisation of a random field by rmpm and by GSTools: the same lattice, CPU time of one thread, best of the repeats.

GSTools sums 1,000 random modes at each cell by default; rmpm subdivides (`auto`). Set-up is not counted on either side.
"""

import argparse
import os
import re
import subprocess
import time
from pathlib import Path

os.environ["OMP_NUM_THREADS"] = "1"

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
REPEATS = 10


def ours(program):
    """Milliseconds by lattice, as the bench `field` prints them: plain subdivision, and `auto` for theta_h = 6 m."""
    command = [program] if program else ["cargo", "bench", "--quiet", "--bench", "field"]
    text = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    row = re.compile(r"^(plain subdivision|auto, theta_h = 6 m)\s+(\d+) x (\d+)\s+\S+\s+(\S+)", re.M)
    return [(name, (int(a), int(b)), float(ms)) for name, a, b, ms in row.findall(text)]


def gstools(cells):
    import gstools as gs

    model = gs.Exponential(dim=2, var=1, len_scale=[3.0, 0.5])
    field = gs.SRF(model, seed=1)
    places = [0.25 * (np.arange(n) + 0.5) for n in cells]
    best = np.inf
    for seed in range(REPEATS if cells[0] < 200 else 1):
        start = time.process_time()
        field(places, seed=seed, mesh_type="structured")
        best = min(best, 1e3 * (time.process_time() - start))
    return best


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", help="the bench `field`, built before; else cargo builds it")
    parser.add_argument("--most", type=int, default=512, help="longest side of a lattice")
    args = parser.parse_args()
    print("milliseconds a realisation (rmpm / GSTools)")
    for name, cells, ms in ours(args.program):
        if max(cells) > args.most:
            continue
        try:
            peer = gstools(cells)
        except ImportError as why:
            print(f"GSTools left out: {why}")
            return
        print(f"  {cells[0]} x {cells[1]:<6}{name:<26} rmpm {ms:8.3f}   GSTools {peer:10.2f} ({ms / peer:.4f})")


if __name__ == "__main__":
    main()
