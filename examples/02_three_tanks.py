"""The published experiment in Python: drive, collide with a tank, plan around it, arrive.

`fgenv run three_tanks` runs the same, prints a report and draws all the paper's figures.
"""

from fgenv.paper.drive import Drive
from fgenv.paper.experiment import Replan, run_experiment
from fgenv.paper.figures import collision
from fgenv.paper.scene import three_tanks

problem = three_tanks()  # or three_tanks("my_robot.stl", scale=0.001)


def report(result: Drive | Replan) -> None:
    """Called with each drive and plan as soon as it is known."""
    if isinstance(result, Replan):
        print(f"a new path of {result.plan.length:.2f} m, proved free")
    elif result.hit is not None:
        hit = result.hit
        print(f"{hit.time:.2f} s: {hit.robot} hits {hit.body} at {hit.contact.point}")


experiment = run_experiment(problem, seed=0, report=report)
for drive in experiment.drives:
    print("masks:", drive.during, "afterwards:", drive.after)
print("at the goal:", experiment.arrived)
collision(experiment).save("collision.png")
print("the moment of the collision: collision.png")
assert experiment.as_published
