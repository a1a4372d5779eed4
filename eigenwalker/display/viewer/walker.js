// Walkers out of numbers. No dependencies and no page: stage.js draws, controls.js listens.
//
// What comes in is the plain dictionary of contents.py. Its arrays are float64, little-endian, as base64, row by row.
// Lengths are in metres: x forward, y to the walker's left, z up. Phase zero is where the left foot is in front.

const TURN = 2 * Math.PI;

/** The rows of an array that was written as base64. */
export function decode(text, columns) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const numbers = new Float64Array(bytes.buffer);
  const rows = columns ? numbers.length / columns : 0;
  return Array.from({ length: rows }, (_, row) => numbers.subarray(row * columns, (row + 1) * columns));
}

function dot(first, second) {
  let sum = 0;
  for (let i = 0; i < first.length; i++) sum += first[i] * second[i];
  return sum;
}

/** Add each row, times its weight, to a vector. */
function addRows(vector, rows, weights) {
  rows.forEach((row, number) => {
    const weight = weights[number];
    for (let i = 0; weight !== 0 && i < vector.length; i++) vector[i] += weight * row[i];
  });
  return vector;
}

/** The solution of a small linear system by elimination, or null where its rows depend on each other. */
export function solve(matrix, right) {
  const rows = matrix.map((row, i) => [...row, right[i]]);
  for (let column = 0; column < rows.length; column++) {
    let best = column;
    for (let i = column; i < rows.length; i++) {
      if (Math.abs(rows[i][column]) > Math.abs(rows[best][column])) best = i;
    }
    if (!(Math.abs(rows[best][column]) > 1e-10)) return null;
    [rows[column], rows[best]] = [rows[best], rows[column]];
    for (let i = 0; i < rows.length; i++) {
      if (i === column) continue;
      const factor = rows[i][column] / rows[column][column];
      for (let j = column; j <= rows.length; j++) rows[i][j] -= factor * rows[column][j];
    }
  }
  return rows.map((row, i) => row[rows.length] / row[i]);
}

/** Equally likely numbers between 0 and 1, the same ones for the same seed (xorshift of 32 bits, Marsaglia 2003). */
export function randomNumbers(seed) {
  let state = (Math.imul(seed + 1, 0x9e3779b1) ^ 0x5bd1e995) >>> 0 || 1;
  const next = () => {
    state ^= state << 13;
    state ^= state >>> 17;
    state ^= state << 5;
    return (state >>> 0) / 2 ** 32;
  };
  for (let i = 0; i < 8; i++) next(); // seeds near each other have parted by then
  return next;
}

/**
 * The linear space of walkers: scores along Eigenwalkers, trait axes through it, and the features of every point.
 *
 * A score counts from the average walker. Alpha of trait t is filters[t] . score; steps[t] is the shortest way to
 * alpha = 1 on trait t when all other traits are free.
 */
export class WalkerSpace {
  constructor(contents) {
    this.contents = contents;
    this.nMarkers = contents.markers.length;
    this.nHarmonics = contents.n_harmonics;
    this.nPosture = 3 * this.nMarkers * (1 + 2 * this.nHarmonics); // frequency follows, then what else is a feature
    this.center = decode(contents.center, contents.n_features)[0];
    this.basis = decode(contents.basis, contents.n_features);
    for (const name of ["filters", "steps", "whitener", "scores"]) {
      this[name] = decode(contents[name], contents.n_components);
    }
    this.structure = Uint8Array.from(contents.structure, (sign) => Number(sign === "1"));
    this.ankles = ["left_ankle", "right_ankle"].map((name) => contents.markers.indexOf(name));
    this.height = Math.max(...this.markersOf(this.center).map(([, , z]) => z));
  }

  alphasOf(score) {
    return this.filters.map((filter) => dot(filter, score));
  }

  /** How far a score is from the average walker, in standard deviations of the walkers learned from. */
  distance(score) {
    return Math.hypot(...this.whitener.map((row) => dot(row, score)));
  }

  scoreOf(walker) {
    return walker === null ? new Float64Array(this.contents.n_components) : this.scores[walker];
  }

  /**
   * The score with wanted alphas, a Map of trait to alpha, on some traits; the others are free to go along. Null where
   * these traits cannot be set independently of each other.
   */
  move(start, wanted) {
    const own = this.alphasOf(start);
    const chosen = [...wanted.keys()];
    const effects = chosen.map((i) => chosen.map((j) => dot(this.filters[i], this.steps[j])));
    const weights = solve(
      effects,
      chosen.map((trait) => wanted.get(trait) - own[trait]),
    );
    return (
      weights &&
      addRows(
        Float64Array.from(start),
        chosen.map((trait) => this.steps[trait]),
        weights,
      )
    );
  }

  /** The features of a score: mean posture, harmonics, frequency. */
  features(score) {
    return addRows(Float64Array.from(this.center), this.basis, score);
  }

  /** The features of a walker that went from one score to another with its whole body, or with one part of it. */
  change(features, start, score, part) {
    const changes = new Float64Array(features.length);
    addRows(
      changes,
      this.basis,
      score.map((value, i) => value - start[i]),
    );
    const goes = (i) => !part || (part === "structure") === (this.structure[i] === 1);
    return features.map((value, i) => value + (goes(i) ? changes[i] : 0));
  }

  /** Mean positions of the markers, one [x, y, z] each. */
  markersOf(vector) {
    return Array.from({ length: this.nMarkers }, (_, marker) => [0, 1, 2].map((axis) => vector[3 * marker + axis]));
  }

  /** From where to where the mean positions of the markers reach along an axis. */
  rangeOf(features, axis) {
    const places = this.markersOf(features).map((place) => place[axis]);
    return [Math.min(...places), Math.max(...places)];
  }

  /** The point to look at: over the place where a body stands, half as high as the average one. */
  middleOf(features) {
    const markers = this.markersOf(features);
    const mean = (axis) => markers.reduce((sum, place) => sum + place[axis], 0) / markers.length;
    return [mean(0), mean(1), 0.5 * this.height];
  }

  /** Add where a marker is at a phase, against its mean position, to an array of points (Troje 2002, Eq. 1). */
  addMotion(vector, marker, phase, harmonics, points, at) {
    for (let k = 1; k <= this.nHarmonics; k++) {
      if (!harmonics[k - 1]) continue;
      const sine = Math.sin(k * phase);
      const cosine = Math.cos(k * phase);
      const place = 3 * (this.nMarkers * (2 * k - 1) + marker);
      for (let axis = 0; axis < 3; axis++) {
        const i = place + axis;
        points[at + axis] += sine * vector[i] + cosine * vector[i + 3 * this.nMarkers];
      }
    }
  }

  /** How fast a belt must run under the feet, in metres a second: the foot that goes back faster is the one on it. */
  beltSpeed(vector, harmonics) {
    if (this.ankles.includes(-1)) return 0;
    const phases = Array.from({ length: 32 }, (_, i) => (TURN * i) / 32);
    const back = (marker, phase) => {
      let sum = 0;
      for (let k = 1; k <= this.nHarmonics; k++) {
        const i = 3 * (this.nMarkers * (2 * k - 1) + marker);
        const slope = vector[i] * Math.cos(k * phase) - vector[i + 3 * this.nMarkers] * Math.sin(k * phase);
        if (harmonics[k - 1]) sum -= k * slope;
      }
      return sum;
    };
    const fastest = phases.map((phase) => Math.max(...this.ankles.map((marker) => back(marker, phase))));
    return TURN * vector[this.nPosture] * (fastest.reduce((sum, one) => sum + one, 0) / phases.length);
  }
}

/** One walker on the stage: whom it starts from, which traits are held at which alpha, where in its stride it is. */
export class Walker {
  constructor(space, { walker = null, held = new Map(), part = null, phase = 0 } = {}) {
    Object.assign(this, { space, phase, way: 0, points: new Float64Array(3 * space.nMarkers) });
    this.place({ walker, held, part });
  }

  /** Go to where held traits are; stay, and return false, where they cannot be set independently of each other. */
  place({ walker = this.walker, held = this.held, part = this.part }) {
    const { space } = this;
    const start = space.scoreOf(walker);
    const score = space.move(start, held);
    if (!score) return false;
    const features = space.features(start);
    const alphas = space.alphasOf(score);
    for (const [trait, alpha] of held) alphas[trait] = alpha; // without the last bit of rounding
    Object.assign(this, { walker, held, part, alphas, distance: space.distance(score) });
    this.middle = space.middleOf(features); // of whom it starts from: sliders do not move the camera
    this.vector = space.change(features, start, score, part);
    this.frequency = this.vector[space.nPosture];
    this.belt = undefined; // until it is asked for
    return true;
  }

  /** Let time pass. The phase grows by what the frequency of this moment allows, so that it never jumps. */
  advance(seconds, harmonics) {
    if (this.belt === undefined) this.belt = this.space.beltSpeed(this.vector, harmonics);
    this.phase = (this.phase + TURN * Math.max(this.frequency, 0) * seconds) % TURN;
    if (this.phase < 0) this.phase += TURN;
    this.way += this.belt * seconds;
  }

  /** Put the markers to where they are at a phase; to it each may add its own. */
  pose(harmonics, shifts = null, phase = this.phase) {
    for (let i = 0; i < this.points.length; i++) this.points[i] = this.vector[i];
    for (let marker = 0; marker < this.space.nMarkers; marker++) {
      const own = shifts ? phase + shifts[marker] : phase;
      this.space.addMotion(this.vector, marker, own, harmonics, this.points, 3 * marker);
    }
    return this.points;
  }
}

/** The markers over some strides as a table, to be read by read_walk; as long as FourierLinearizer makes its walks. */
export function csvOf(walker, harmonics, { strides = 10, frameRate = 120 } = {}) {
  const quote = (name) => (/[",\n\r]/.test(name) ? `"${name.replaceAll('"', '""')}"` : name);
  const columns = walker.space.contents.markers.flatMap((marker) => ["x", "y", "z"].map((axis) => `${marker}_${axis}`));
  const count = Math.max(1, Math.round((strides * frameRate) / walker.frequency));
  const rows = Array.from({ length: count }, (_, frame) => {
    const time = frame / frameRate;
    return [time, ...walker.pose(harmonics, null, TURN * walker.frequency * time)].join(",");
  });
  return `${[["time", ...columns.map(quote)].join(","), ...rows].join("\n")}\n`;
}
