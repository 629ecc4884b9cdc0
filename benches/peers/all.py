"""All comparisons in one go."""

import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent

for script in ("solver.py", "fields.py", "explicit.py"):
    print(f"\n== {script}", flush=True)
    subprocess.run([sys.executable, HERE / script], check=False)
