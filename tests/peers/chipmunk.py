"""Runs a job in pymunk, in the same way as src/drive.rs, where the parts are documented.

Moment infinite, friction 0, damping 1 (none), elasticity √e on each shape, because pymunk multiplies
them. It has no restitution threshold, no speed limit and no continuous collision detection. Its
collision_slop of 0.1 is meant for pixels; at 100 pixels per metre it is 0.001 m. Everything else is the
default: 10 iterations.
"""

import json
import math
import sys
import time
from array import array

import pymunk


class World:
    def __init__(self, job):
        self.seconds = 1 / job["rate"]
        self.space = pymunk.Space()
        self.space.gravity = tuple(job["gravity"])
        self.space.collision_slop = 0.001
        if job["sleep"]:
            self.space.sleep_time_threshold = 0.5
        self.boxes = job["bodies"]
        self.bodies = [self.insert(box, math.sqrt(job["restitution"])) for box in self.boxes]
        # A force lasts for one step.
        forces = [(body, (box["fx"], box["fy"])) for body, box in zip(self.bodies, self.boxes)]
        self.forces = [(body, force) for body, force in forces if force != (0, 0)]

    def insert(self, box, elasticity):
        fixed = box["mass"] is None
        body = pymunk.Body(body_type=pymunk.Body.STATIC) if fixed else pymunk.Body(box["mass"], math.inf)
        body.position = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        body.velocity = box["vx"], box["vy"]
        shape = pymunk.Poly.create_box(body, (box["width"], box["height"]))
        shape.friction = 0
        shape.elasticity = elasticity
        self.space.add(body, shape)
        return body

    def step(self):
        for body, force in self.forces:
            body.force = force
        self.space.step(self.seconds)

    def state(self, index):
        box, body = self.boxes[index], self.bodies[index]
        return (body.position.x - box["width"] / 2, body.position.y - box["height"] / 2, *body.velocity)


def run_sampled(job, answer):
    world = World(job)
    samples = array("d")
    start = time.process_time()
    for step in range(1, sum(job["phases"]) + 1):
        world.step()
        answer["steps"] = step
        if step % job["sample_every"] == 0:
            for index in range(len(job["bodies"])):
                samples.extend(world.state(index))
            if time.process_time() - start > job["limit"]:
                break
    if sys.byteorder == "big":
        samples.byteswap()
    with open(job["samples"], "wb") as file:
        samples.tofile(file)


def time_phases(job, steps, batch):
    seconds = [0.0] * len(job["phases"])
    for _ in range(batch):
        step = World(job).step
        remaining = steps
        for index, phase in enumerate(job["phases"]):
            count = min(remaining, phase)
            remaining -= count
            start = time.process_time()
            for _ in range(count):
                step()
            seconds[index] += (time.process_time() - start) / batch
    return seconds


def main():
    job = json.load(sys.stdin)
    version = f"{pymunk.version} (Chipmunk {pymunk.chipmunk_version.split('-')[0]})"
    answer = {"version": version, "refused": None, "steps": 0, "seconds": [], "collisions": None}
    run_sampled(job, answer)
    total, batch = 0.0, 1
    while True:
        seconds = time_phases(job, answer["steps"], batch)
        spent = sum(seconds)
        if batch == 1 and spent < 0.01:
            batch = min(max(math.ceil(0.02 / spent), 2), 200)
            continue
        total += spent * batch
        answer["seconds"].append(seconds)
        if (len(answer["seconds"]) >= 5 and total >= 0.3) or total >= 4:
            break
    print(json.dumps(answer))


if __name__ == "__main__":
    main()
