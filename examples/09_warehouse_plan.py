"""Carts of a warehouse: planned together, simulated, recorded and replayed."""

import fgenv
from fgenv.agents import PlanPolicy, run_episode
from fgenv.envs import Record, Simulator, replay
from fgenv.metrics import Results
from fgenv.scenarios import Scenario

scenario = Scenario.load("warehouse", n=8, seed=1)
plan = fgenv.plan(scenario, method="prioritized", seed=1, margin=1e-3)
proof = plan.certificate
assert proof.proved
print(f"planned: makespan {plan.makespan:.1f} s, sum of costs {plan.sum_of_costs:.1f} s,")
print(f"proved free for {proof.steps} steps, no robot comes nearer than {proof.clearance:.4f} m")

simulator = Simulator(scenario, clearance=True, autoreset=False)
policy = PlanPolicy(plan=plan)  # or policy_of("plan:prioritized"), which plans each episode
record = run_episode(simulator, policy, seed=1)
results = Results.of(record)
assert results.success_rate == 1.0
assert results.steps_in_contact == 0
print(f"driven: {results.makespan:.1f} s, {policy.tracking_error:.1e} m off the plan at most")

record.save("warehouse.npz")
replay(Record.load("warehouse.npz"))  # the same bits, or an error that names the step
print("run again from its record: the same, bit for bit")
