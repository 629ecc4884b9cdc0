"""Compares fields of `rmpm field` with fields of GSTools: the same model on the same cells.

    rmpm field CASE -n 400 --formats npy --out DIR
    python validation/gstools/compare.py DIR NAME [--fields 400] [--sub 4]

For one field of the case: mean, variance and correlation at a few lags along both axes, each with its standard
error over the fields, beside its exact value; and the time a field takes. GSTools gives values at points; here they are averaged over
`sub` x `sub` points of each cell, which has an exact value of its own. Ends with 1 where a figure is off its exact value
by more than four standard errors, with 77 where GSTools is not installed.

GSTools' exponential model is exp(-r / len_scale), ours exp(-2 r / theta): len_scale = theta / 2.
"""

import argparse
import json
import sys
import time
from pathlib import Path

try:
    import gstools
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing}; install it with: python -m pip install gstools")
    sys.exit(77)

BOUND = 4.0


def standard(values, field):
    """Values of the marginal back to the Gaussian field of variance 1 at a point."""
    kind, mean, sd = field["distribution"], field["mean"], field["sd"]
    if field["depth_gradient"] != 0:
        sys.exit("the mean of this field changes with depth: compare one without a trend")
    if kind == "normal":
        return (values - mean) / sd
    if kind == "lognormal":
        spread = np.log1p((sd / mean) ** 2)
        return (np.log(values) - np.log(mean) + spread / 2) / np.sqrt(spread)
    sys.exit(f"the distribution '{kind}' has no inverse here: compare a normal or lognormal field")


def ours(folder, field, most):
    paths = [folder / f"field-{field['name']}-{k}.npy" for k in field["realisations"][:most]]
    fields = np.array([np.load(path) for path in paths])
    assert fields.shape[1:] == (field["cells"][1], field["cells"][0]), fields.shape
    return standard(fields, field)


def theirs(field, count, sub):
    """Point values on a grid `sub` times finer, averaged over the cells."""
    family, theta = field["correlation"], field["theta_m"]
    models = {
        "markov": lambda: gstools.Exponential(dim=2, var=1, len_scale=[theta[0] / 2, theta[1] / 2]),
        # exp(-pi (x / theta)^2) on both sides
        "gaussian": lambda: gstools.Gaussian(dim=2, var=1, len_scale=theta, rescale=np.sqrt(np.pi)),
    }
    if family not in CORRELATIONS:
        sys.exit(f"GSTools has no counterpart of '{family}' here: compare markov or gaussian")
    axes = [(np.arange(n * sub) + 0.5) * cell / sub for n, cell in zip(field["cells"], field["cell_m"])]
    random = gstools.SRF(models[family](), mean=0)
    wide, high = field["cells"]
    fields, spent = [], 0.0
    for k in range(count):
        before = time.perf_counter()
        points = random.structured(axes, seed=20_000 + k)
        fields.append(points.T.reshape(high, sub, wide, sub).mean(axis=(1, 3)))
        spent += time.perf_counter() - before
    return np.array(fields), 1e3 * spent / count


CORRELATIONS = {"markov": lambda r: np.exp(-2 * r), "gaussian": lambda r: np.exp(-np.pi * r * r)}


def of_points(field, sub, lag):
    """Exact covariance of the means of `sub` x `sub` points of two cells."""
    steps = np.arange(1 - sub, sub)
    weights = (sub - abs(steps)) / sub**2
    x, z = ((n + steps / sub) * cell / theta for n, cell, theta in zip(lag, field["cell_m"], field["theta_m"]))
    distance = np.hypot(x[:, None], z[None, :])
    return weights @ CORRELATIONS[field["correlation"]](distance) @ weights


def estimate(per_field):
    """Mean over the fields and its standard error."""
    return per_field.mean(), per_field.std(ddof=1) / np.sqrt(len(per_field))


def covariance(fields, lag):
    """Mean product of cells at a lag, field by field; the mean is known to be 0."""
    i, j = lag
    high, wide = fields.shape[1:]
    product = fields[:, : high - j, : wide - i] * fields[:, j:, i:]
    return product.mean(axis=(1, 2))


def correlation(fields, lag):
    """Correlation over all fields, and its standard error to first order in the scatter of the two sums."""
    lagged, square = covariance(fields, lag), covariance(fields, (0, 0))
    value = lagged.mean() / square.mean()
    return value, estimate((lagged - value * square) / square.mean())[1]


def rows(field, a, b, sub):
    """Name, then of ours and theirs: exact value, (estimate, standard error)."""
    variance = of_points(field, sub, (0, 0))
    yield "mean", *((0.0, estimate(f.mean(axis=(1, 2)))) for f in (a, b))
    exact = field["target_variance"], variance
    yield "variance", *((e, estimate(covariance(f, (0, 0)))) for e, f in zip(exact, (a, b)))
    for row in field["correlations"]:
        lag, name = row["lag_cells"], "rho at ({:g}, {:g}) m".format(*row["lag_m"])
        exact = row["target"], of_points(field, sub, lag) / variance
        yield name, *((e, correlation(f, lag)) for e, f in zip(exact, (a, b)))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("name")
    parser.add_argument("--fields", type=int, default=400, help="most fields of each")
    parser.add_argument("--sub", type=int, default=4, help="points a cell and axis")
    args = parser.parse_args()
    record = json.loads((args.folder / "field.json").read_text())
    timing = json.loads((args.folder / "field_timing.json").read_text())
    field = next((f for f in record["fields"] if f["name"] == args.name), None)
    if field is None:
        sys.exit(f"no field '{args.name}' in {args.folder}: {[f['name'] for f in record['fields']]}")
    a = ours(args.folder, field, args.fields)
    if len(a) < 10:
        sys.exit(f"{len(a)} fields are too few: rmpm field CASE -n 400")
    b, their_time = theirs(field, len(a), args.sub)
    our_time = timing["ms_per_field"][args.name]
    print(f"field '{args.name}': {field['correlation']}, theta {field['theta_m']} m, {field['cells']} cells of "
          f"{field['cell_m']} m; {len(a)} fields each")
    print(f"{'':20}{'rmpm, exact':>14}{'sampled':>20}{'off/s.e.':>10}{'GSTools, exact':>17}{'sampled':>20}{'off/s.e.':>10}")
    off = 0
    for name, *sides in rows(field, a, b, args.sub):
        scores = [(value - exact) / error for exact, (value, error) in sides]
        off += sum(abs(score) > BOUND for score in scores)
        (e, (x, ex)), (f, (y, ey)) = sides
        print(f"{name:20}{e:14.4f}{f'{x:.4f} +- {ex:.4f}':>20}{scores[0]:10.1f}"
              f"{f:17.4f}{f'{y:.4f} +- {ey:.4f}':>20}{scores[1]:10.1f}")
    print(f"{'ms a field':20}{'':14}{our_time:20.3f}{'':27}{their_time:20.1f}   "
          f"(GSTools {gstools.__version__}, {args.sub} x {args.sub} points a cell)")
    if off:
        sys.exit(f"{off} figures are off by more than {BOUND:g} standard errors")


if __name__ == "__main__":
    main()
