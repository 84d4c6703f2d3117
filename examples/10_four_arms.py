"""Four arms at one table planned together; the plan is certified in continuous time."""

import numpy as np

import fgenv
from fgenv.scenarios import Scenario

scenario = Scenario.load("cell", n=4, seed=0)
plan = fgenv.plan(scenario, method="composite", seed=0, time_limit=30.0)
proof = plan.certificate
assert proof.proved
assert proof.nearest is not None
step, arm, other = proof.nearest
print(f"{len(plan.configurations)} arms, {plan.steps} steps of {plan.dt} s, found in")
print(f"{plan.facts['seconds']:.2f} s: clearance at least {1000 * proof.clearance:.2f} mm")
print(f"(nearest: {arm} to {other}, after {step * plan.dt:.1f} s)")

# Plans are plain arrays: joint angles at any time, in radians.
for robot, q in zip(scenario.robots, plan.at(0.5 * plan.makespan), strict=True):
    print(f"{robot.name} half way: {np.round(q, 2)}")
