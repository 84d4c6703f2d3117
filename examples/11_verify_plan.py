"""A plan is certified again from its file alone; modified files are refused."""

import numpy as np

import fgenv
from fgenv.planners import Plan, PlanError
from fgenv.planners.plan import PLAN

fgenv.plan("doorway", n=2, seed=0, method="composite").save("plan.npz")
proof = fgenv.verify("plan.npz")
assert proof
print(f"plan.npz: proved, {proof.steps} steps, no robot nearer than {proof.clearance:.4f} m")

wide = fgenv.verify("plan.npz", margin=10.0)
assert not wide
print(f"with 10 m to spare it is not: step {wide.failed_step}")

# A jump of one meter to the side: the hash of the file does not match.
with np.load("plan.npz") as file:
    arrays = dict(file)
arrays["configurations_0"][20, 0] += 1.0
np.savez("damaged.npz", **arrays)
try:
    Plan.load("damaged.npz")
    raise SystemExit("a damaged plan was read")
except PlanError as error:
    print(error)

# With a new hash the file is still refused: the speed limit or the certificate fails.
texts = {name: str(arrays[name]) for name in ("scenario", "about")}
rows = {
    f"{name}_{i}": arrays[f"{name}_{i}"] for name in ("configurations", "waypoints") for i in (0, 1)
}
np.savez("forged.npz", **{**arrays, "id": PLAN.id(texts, rows)})
try:
    assert not fgenv.verify("forged.npz")
    print("forged.npz: read, but not proved")
except PlanError as error:
    print(error)
