// matter-js, at its usual scale of 100 units per metre. Inertia infinite, friction and air friction 0,
// restitution e on both bodies (the larger counts), _restingThresh 0 if e > 0 (at e = 0 it only affects how
// resting contacts are solved, and 0 makes stacks worse). It has no continuous collision detection and no
// speed limit. Everything else is the default: 6 position and 4 velocity iterations, a slop of 0.05 units.
import { readFileSync } from "node:fs";
import Matter from "matter-js";
import { drive } from "./drive.mjs";

const UNITS = 100;
const { Bodies, Body, Composite, Engine, Resolver } = Matter;
const { version } = JSON.parse(readFileSync(new URL("node_modules/matter-js/package.json", import.meta.url)));

drive(version, (job) => {
  if (job.restitution > 0) Resolver._restingThresh = 0;
  const engine = Engine.create({ enableSleeping: job.sleep });
  // Forces are in kg·units/ms².
  engine.gravity = { x: job.gravity[0], y: job.gravity[1], scale: UNITS * 1e-6 };
  const bodies = job.bodies.map(({ x, y, width, height, mass, vx, vy }) => {
    const body = Bodies.rectangle((x + width / 2) * UNITS, (y + height / 2) * UNITS, width * UNITS, height * UNITS, {
      isStatic: mass === null,
      friction: 0,
      frictionStatic: 0,
      frictionAir: 0,
      restitution: job.restitution,
    });
    body.restitution = job.restitution;
    body.friction = 0;
    if (mass !== null) {
      Body.setMass(body, mass);
      Body.setInertia(body, Infinity);
      // Velocities are per 1/60 s at every rate.
      Body.setVelocity(body, { x: (vx * UNITS) / 60, y: (vy * UNITS) / 60 });
    }
    Composite.add(engine.world, body);
    return body;
  });
  // A force lasts for one step, and is in kg·units/ms².
  const scale = UNITS * 1e-6;
  const pushed = job.bodies.map(({ fx, fy }, index) => [bodies[index], fx, fy]).filter(([, fx, fy]) => fx || fy);
  return {
    step: () => {
      for (const [body, fx, fy] of pushed) body.force = { x: fx * scale, y: fy * scale };
      Engine.update(engine, 1000 / job.rate);
    },
    state: (body) => {
      const { width, height } = job.bodies[body];
      const { position, velocity } = bodies[body];
      return [
        position.x / UNITS - width / 2,
        position.y / UNITS - height / 2,
        (velocity.x * 60) / UNITS,
        (velocity.y * 60) / UNITS,
      ];
    },
  };
});
