// The handout's algorithm in JavaScript, the language of its course: the twin with which the `handout` solver is
// compared bit for bit. R1 to R4 are the four corrections that the solver documents.

export class Vector {
  constructor(x, y) { this.x = x; this.y = y; Object.freeze(this); }
  add(v) { return new Vector(this.x + v.x, this.y + v.y); }
  sub(v) { return new Vector(this.x - v.x, this.y - v.y); }
  mult(k) { return new Vector(this.x * k, this.y * k); }
  dot(v) { return this.x * v.x + this.y * v.y; }
  norm() { return Math.sqrt(this.x * this.x + this.y * this.y); }
  static ZERO = new Vector(0, 0);
}

export class Rect {
  constructor(v, w, h) { this.origin = v; this.width = w; this.height = h; }
  move(v) { this.origin = this.origin.add(v); }
  mDiff(r) {
    return new Rect(
      new Vector(r.origin.x - this.origin.x - this.width, r.origin.y - this.origin.y - this.height),
      r.width + this.width,
      r.height + this.height,
    );
  }
  hasOrigin() {
    return this.origin.x <= 0 && 0 <= this.origin.x + this.width
      && this.origin.y <= 0 && 0 <= this.origin.y + this.height;
  }
}

export class Body extends Rect {
  constructor({ name, at, size, mass, velocity = [0, 0], force = [0, 0], material = "" }) {
    super(new Vector(...at), ...size);
    this.name = name;
    this.mass = mass;
    this.invMass = 1 / mass;
    this.velocity = new Vector(...velocity);
    this.force = Vector.ZERO;
    this.constantForce = new Vector(...force);
    this.material = material;
  }

  collision(b, restitution) {
    const c = this;
    if (c.mass === Infinity && b.mass === Infinity) return null; // R3
    const s = c.mDiff(b);
    if (!s.hasOrigin()) return null;
    const faces = [
      [new Vector(s.origin.x, 0), new Vector(-1, 0)],
      [new Vector(s.origin.x + s.width, 0), new Vector(1, 0)],
      [new Vector(0, s.origin.y), new Vector(0, -1)],
      [new Vector(0, s.origin.y + s.height), new Vector(0, 1)],
    ];
    let [n, normal] = faces[0]; // R1: the face's own normal
    for (const [candidate, unit] of faces.slice(1)) {
      if (candidate.norm() < n.norm()) [n, normal] = [candidate, unit];
    }
    const speedC = c.velocity.norm(), speedB = b.velocity.norm();
    let nC = speedC / (speedC + speedB), nB = speedB / (speedC + speedB);
    if (speedC === 0 && speedB === 0) [nC, nB] = b.mass > c.mass ? [1, 0] : [0, 1];
    if (c.mass === Infinity) [nC, nB] = [0, 1]; // R4
    if (b.mass === Infinity) [nC, nB] = [1, 0]; // R4
    c.move(n.mult(nC));
    b.move(n.mult(-nB));
    const vn = c.velocity.sub(b.velocity).dot(normal);
    if (vn >= 0) return null; // R2
    const e = restitution(c.material, b.material);
    const j = -(1 + e) * vn / (c.invMass + b.invMass);
    return {
      velocity1: c.velocity.add(normal.mult(j * c.invMass)),
      velocity2: b.velocity.sub(normal.mult(j * b.invMass)),
    };
  }
}

export class Engine {
  constructor({ gravity = null, restitution = () => 1 }) {
    this.bodies = [];
    this.gravity = gravity && new Vector(...gravity);
    this.restitution = restitution;
  }

  update(dt) {
    for (const c of this.bodies) {
      for (const b of this.bodies) {
        if (b === c) continue;
        const rebound = c.collision(b, this.restitution);
        if (rebound) {
          c.velocity = rebound.velocity1;
          b.velocity = rebound.velocity2;
        }
      }
      c.force = c.force.add(c.constantForce);
      if (this.gravity && c.mass !== Infinity) c.force = c.force.add(this.gravity.mult(c.mass));
      const acceleration = c.force.mult(c.invMass);
      c.force = Vector.ZERO;
      c.velocity = c.velocity.add(acceleration.mult(dt));
      c.move(c.velocity.mult(dt));
    }
  }
}

export function walls([width, height], material = "") {
  const wall = (name, at, size) => new Body({ name, at, size, mass: Infinity, material });
  return [
    wall("wall-top", [-1, -1], [width + 2, 1]),
    wall("wall-bottom", [-1, height], [width + 2, 1]),
    wall("wall-left", [-1, 0], [1, height]),
    wall("wall-right", [width, 0], [1, height]),
  ];
}
