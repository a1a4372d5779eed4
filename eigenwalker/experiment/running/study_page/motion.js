// Where the markers of a walk are at any time, in metres: x forward, y to the walker's left, z up.
import { Walker } from "./walker.js";

const STRIDES = 10; // of harmonics, where nobody says how long they last
const SAMPLES = 64; // of a stride, to see how far it reaches

/** A walk out of its Fourier coefficients: in place, for as long as one likes (Troje 2002, Eq. 1). */
export class HarmonicMotion {
  constructor(space, { walker, middle, height, elevation = 0, duration }) {
    const { markers, sticks } = space.contents;
    Object.assign(this, { markers, sticks, middle, height, elevation });
    this.walker = new Walker(space, { walker });
    this.harmonics = Array(space.nHarmonics).fill(true);
    const { frequency } = this.walker;
    this.duration = duration ?? STRIDES / frequency;
    this.samples = Array.from({ length: SAMPLES }, (_, i) => i / (SAMPLES * frequency));
  }

  /** Three numbers for each marker, at a time in seconds. */
  at(time) {
    return this.walker.pose(this.harmonics, null, 2 * Math.PI * this.walker.frequency * time);
  }
}

/** A walk frame by frame, in place or on its way; between two frames markers go straight. */
export class FramedMotion {
  constructor({ rate, markers, sticks, positions, path }, isOnItsWay) {
    Object.assign(this, { rate, markers, sticks, elevation: 0, middle: null });
    this.frames = singles(positions, 3 * markers.length);
    this.path = isOnItsWay ? singles(path, 2) : null;
    this.duration = this.frames.length / rate;
    this.samples = this.frames.map((_, frame) => frame / rate);
    this.height = rangeOf(this.frames.flatMap((frame) => [...frame.filter((_, i) => i % 3 === 2)])).size;
    this.points = new Float64Array(3 * markers.length);
  }

  at(time) {
    const last = this.frames.length - 1;
    const place = Math.min(Math.max(time * this.rate, 0), last);
    const [before, after] = [Math.floor(place), Math.min(Math.floor(place) + 1, last)];
    const mix = (rows, i) => rows[before][i] + (place - before) * (rows[after][i] - rows[before][i]);
    for (let i = 0; i < this.points.length; i++) this.points[i] = mix(this.frames, i);
    if (this.path) for (let i = 0; i < this.points.length; i++) if (i % 3 < 2) this.points[i] += mix(this.path, i % 3);
    return this.points;
  }
}

/** From where to where numbers reach, and the middle of this. */
export function rangeOf(numbers) {
  let [low, high] = [Infinity, -Infinity];
  for (const number of numbers) [low, high] = [Math.min(low, number), Math.max(high, number)];
  return { low, high, middle: (low + high) / 2, size: high - low };
}

/** The rows of an array of 32-bit numbers that was written as base64. */
function singles(text, columns) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const numbers = new Float32Array(bytes.buffer);
  return Array.from({ length: numbers.length / columns }, (_, row) =>
    numbers.subarray(row * columns, (row + 1) * columns),
  );
}
