// planck, a port of Box2D v2 to JavaScript. Rotation fixed, which also removes the inertia; friction and
// damping 0, restitution e on both fixtures (the larger counts), no maxTranslation, velocityThreshold 0
// except in columns and heaps, which come to rest only with its default of 1 m/s. Every polygon has a skin
// of twice linearSlop, 1 cm, which is subtracted from the size of the boxes unless they are thinner.
// Everything else is the default: 8 velocity and 3 position iterations.
import { readFileSync } from "node:fs";
import { Box, Settings, World } from "planck";
import { drive } from "./drive.mjs";

Settings.maxTranslation = 1e9;
const { version } = JSON.parse(readFileSync(new URL("node_modules/planck/package.json", import.meta.url)));

const withoutSkin = (half) => (half > 2 * Settings.polygonRadius ? half - Settings.polygonRadius : half);

drive(version, (job) => {
  Settings.velocityThreshold = job.sleep ? 1 : 0;
  const world = new World({
    gravity: { x: job.gravity[0], y: job.gravity[1] },
    allowSleep: job.sleep,
  });
  const bodies = job.bodies.map(({ x, y, width, height, mass, vx, vy, bullet }) => {
    const body = world.createBody({
      type: mass === null ? "static" : "dynamic",
      position: { x: x + width / 2, y: y + height / 2 },
      linearVelocity: { x: vx, y: vy },
      fixedRotation: true,
      bullet,
      allowSleep: job.sleep,
    });
    const shape = new Box(withoutSkin(width / 2), withoutSkin(height / 2));
    body.createFixture({ shape, density: 1, friction: 0, restitution: job.restitution });
    if (mass !== null) body.setMassData({ mass, center: { x: 0, y: 0 }, I: 0 });
    return body;
  });
  const pushed = job.bodies.map(({ fx, fy }, index) => [bodies[index], fx, fy]).filter(([, fx, fy]) => fx || fy);
  return {
    step: () => {
      for (const [body, x, y] of pushed) body.applyForceToCenter({ x, y }, true); // Lasts for one step.
      world.step(1 / job.rate, 8, 3);
    },
    state: (body) => {
      const { width, height } = job.bodies[body];
      const center = bodies[body].getPosition();
      const velocity = bodies[body].getLinearVelocity();
      return [center.x - width / 2, center.y - height / 2, velocity.x, velocity.y];
    },
  };
});
