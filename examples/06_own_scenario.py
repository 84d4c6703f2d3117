"""A scenario of your own: an STL file as the robot, a YAML file, and an episode on it."""

from pathlib import Path

import trimesh

from fgenv.agents import run_episode
from fgenv.envs import Simulator, policy_of
from fgenv.metrics import Results
from fgenv.scenarios import Scenario, validate

# Any mesh works; this one is in millimeters, as in CAD files.
hull = trimesh.creation.capsule(height=600.0, radius=150.0)
hull.apply_transform(trimesh.transformations.rotation_matrix(1.5708, [0, 1, 0]))
hull.apply_translation([0.0, 0.0, 160.0])
hull.export("vessel.stl")

Path("harbour.yaml").write_text("""
version: 1
name: harbour
workspace: {low: [-6.0, -4.0], high: [6.0, 4.0]}
shapes:
  vessel: {kind: mesh, file: vessel.stl, scale: 0.001}
  quay: {kind: block, size: [0.4, 3.0, 0.5]}
models:
  vessel:
    shape: vessel
    drive: {kind: differential, speed: 1.0, turn_rate: 1.0, acceleration: 0.5}
    lidar: {rays: 24, range: 4.0}
robots:
- {name: one, model: vessel, start: [-5.0, 2.5, 0.0], goal: [5.0, 2.5, 0.0]}
- {name: two, model: vessel, start: [5.0, -2.5, 3.14], goal: [-5.0, -2.5, 3.14]}
bodies:
- {name: quay, shape: quay}
""")
assert validate("harbour.yaml") == []

scenario = Scenario.load("harbour.yaml")
simulator = Simulator(scenario, clearance=True, autoreset=False)
for part in simulator.layouts[0]:
    print(f"{part.name:>10}  numbers {part.slice.start} to {part.slice.stop - 1}, {part.unit}")
record = run_episode(simulator, policy_of("goto"))
record.save("harbour.npz")
for robot in Results.of(record).robots:
    print(f"{robot.name}: {'arrived' if robot.success else 'not there'}, {robot.path_length:.2f} m")
assert Results.of(record).success_rate == 1.0
