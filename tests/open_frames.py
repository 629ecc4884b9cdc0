"""Opens run.pvd and every frame of a run's folder in PyVista and checks what they hold.

Usage: python open_frames.py FOLDER. Exits with 77 (skipped) where PyVista is not installed.
"""

import sys
from pathlib import Path

try:
    import numpy as np
    import pyvista
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

ARRAYS = {
    "displacement": 3, "velocity": 3, "stress": 4, "plastic_strain": 1, "strength": 1,
    "peak_strength": 1, "stage": 1, "material": 1, "jacobian": 1, "mass": 1,
    "initial_volume": 1, "strain_energy": 1, "reference": 3,
}


def print_ranges(mesh):
    for name in mesh.point_data:
        values = np.asarray(mesh.point_data[name])
        finite = values[np.isfinite(values)]
        bounds = f"{finite.min():.6g} .. {finite.max():.6g}" if finite.size else "no finite value"
        print(f"  {name:15} {str(values.dtype):8} {str(values.shape):12} {bounds}")


def check(mesh, time):
    for name, components in ARRAYS.items():
        values = np.asarray(mesh.point_data[name])
        assert values.size == mesh.n_points * components, f"{name}: {values.shape}"
    assert mesh.n_verts == mesh.n_points, "one vertex for each point"
    assert mesh.field_data["TimeValue"][0] == time, "time of the frame and of run.pvd"
    assert not (np.asarray(mesh.point_data["plastic_strain"]) < 0).any(), "plastic_strain < 0"
    moved = mesh.points - mesh.point_data["reference"]
    assert np.array_equal(moved, mesh.point_data["displacement"], equal_nan=True)
    assert set(np.unique(mesh.point_data["stage"])) <= {0, 1, 2, 3}


def main(folder):
    reader = pyvista.get_reader(str(folder / "run.pvd"))
    times = list(reader.time_values)
    assert times, "run.pvd lists no frame"
    counts = []
    for k, time in enumerate(times):
        reader.set_active_time_point(k)
        mesh = reader.read()[0]
        print(f"t = {time} s, step {int(mesh.field_data['step'][0])}: {mesh.n_points} points")
        print_ranges(mesh)
        check(mesh, time)
        counts.append(mesh.n_points)
    assert len(set(counts)) == 1, f"point counts differ: {counts}"
    files = sorted((folder / "frames").glob("*.vtp"))
    assert all(pyvista.read(str(f)).n_points == counts[0] for f in files)
    print(f"{len(times)} times, {len(files)} frames, {counts[0]} points each")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(Path(sys.argv[1]))
