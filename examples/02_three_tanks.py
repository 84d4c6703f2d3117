"""The published experiment in Python: drive, meet a tank, plan around it, arrive.

`fgenv run three_tanks` does the same with an account and all the paper's figures.
"""

from fgenv.agents import Hit, Replanned, run_experiment
from fgenv.agents.events import Event
from fgenv.paper.figures import collision
from fgenv.scenarios import three_tanks

scene = three_tanks()  # or three_tanks("my_robot.stl", scale=0.001)


def report(event: Event) -> None:
    """Called as it happens."""
    if isinstance(event, Hit):
        print(f"{event.time:.2f} s: {event.mover} hits {event.body} at {event.contact.point}")
    elif isinstance(event, Replanned):
        print(f"{event.time:.2f} s: a new path of {event.plan.length:.2f} m, proved free")


experiment = run_experiment(scene, seed=0, report=report)
for drive in experiment.journey.drives:
    print("masks:", drive.masks.masks, "afterwards:", drive.cleared.masks)
print("at the goal:", experiment.journey.arrived)
collision(experiment).save("collision.png")
print("the moment of the collision: collision.png")
assert experiment.as_published
