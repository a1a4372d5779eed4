// Pictures of a walk on a canvas: dots or a stick figure, light on black, in orthographic projection.
import { makeCamera } from "./stage.js";
import { rangeOf } from "./motion.js";
import { Play, showFrames } from "./timing.js";

const FILLED = 0.9; // part of the canvas that a walk fills where its size is not given
const DOT = { degrees: 0.25, part: 1 / 40 }; // of the body's height, where that is not given in degrees
const [STICK, HEAD] = [0.024, 0.125]; // of the body's height: how wide sticks are, and the head
const [DOTS, STICKS] = ["#fff", "#c8ccd2"];

/** Pixels that a line in the middle of the screen is long, seen at an angle from a distance in pixels. */
export const pixelsAcross = (degrees, distance) => 2 * distance * Math.tan((Math.PI * degrees) / 360);

/** A motion as it is seen from one side: to the right and up, in metres from the middle of the picture. */
export class Figure {
  constructor(motion, azimuth) {
    Object.assign(this, { motion, places: new Float64Array(2 * motion.markers.length), spot: new Float64Array(4) });
    this.camera = makeCamera({ azimuth, elevation: motion.elevation, perspective: false });
    this.center = [0, 0];
    const reaches = this.reach();
    if (!motion.middle) this.center = reaches.map(({ middle }) => middle);
    this.size = reaches.map(({ low, high }, axis) => {
      return 2 * Math.max(high - this.center[axis], this.center[axis] - low);
    });
  }

  /** How far it reaches to the sides and up and down, over all of its time. */
  reach() {
    const sides = [[], []];
    for (const time of this.motion.samples) {
      const seen = this.at(time);
      for (let i = 0; i < seen.length; i++) sides[i % 2].push(seen[i]);
    }
    return sides.map(rangeOf);
  }

  /** Two numbers for each marker, at a time in seconds. */
  at(time) {
    const points = this.motion.at(time);
    const [x, y, z] = this.motion.middle ?? [0, 0, 0];
    for (let i = 0; i < this.places.length / 2; i++) {
      this.camera(points[3 * i] - x, points[3 * i + 1] - y, points[3 * i + 2] - z, this.spot, 0);
      this.places[2 * i] = this.spot[0] - this.center[0];
      this.places[2 * i + 1] = this.spot[1] - this.center[1];
    }
    return this.places;
  }
}

/** A walk on a canvas. After a play the canvas is black. */
export class CanvasWalk {
  constructor(canvas, figure, task) {
    Object.assign(this, { canvas, figure, task, time: null, seen: null });
    this.context = canvas.getContext("2d", { alpha: false });
    this.duration = 1000 * (task.duration ?? figure.motion.duration);
    this.ready = Promise.resolve();
  }

  /** See how much room there is; `distance` is that of the eye, in CSS pixels. */
  resize(distance) {
    const { parentElement: place } = this.canvas;
    Object.assign(this, { distance, room: [place.clientWidth, place.clientHeight] });
  }

  /** Metres that heads or dots are wide, where the task does not say it in degrees. */
  get width() {
    const { figure, dot_degrees: dot } = this.task;
    const part = figure === "dots" ? ((dot ?? DOT.degrees) / DOT.degrees) * DOT.part : HEAD;
    return part * this.figure.motion.height;
  }

  /** Pixels a metre that the task asks for, or with which all of the walk is in the picture. */
  get wantedScale() {
    const { figure, task } = this;
    if (task.height_degrees !== null) return pixelsAcross(task.height_degrees, this.distance) / figure.motion.height;
    return Math.min(...this.room.map((side, axis) => (FILLED * side) / (figure.size[axis] + this.width)));
  }

  /** Take a scale, the same one for all walks of a trial. The canvas is as large as the walk needs: that is faster. */
  set scale(scale) {
    const { figure, height_degrees: degrees, dot_degrees: dot } = this.task;
    const isGiven = figure === "dots" && degrees !== null;
    const rim = (isGiven ? pixelsAcross(dot ?? DOT.degrees, this.distance) : this.width * scale) / 2;
    this.pixels = scale;
    this.dot = rim;
    const needed = this.figure.size.map((size) => Math.ceil(size * scale + 2 * rim) + 2);
    this.isWhole = needed.every((side, axis) => side <= this.room[axis] + 2);
    this.resizeCanvas(needed.map((side, axis) => Math.min(side, this.room[axis])));
    if (this.time === null) this.clear();
    else this.draw(this.time);
  }

  /** As many pixels as the screen has there, so that dense screens are sharp. */
  resizeCanvas(size) {
    const { canvas } = this;
    this.density = globalThis.devicePixelRatio || 1;
    const [width, height] = size.map((side) => Math.max(1, Math.round(side * this.density)));
    Object.assign(canvas, { width, height });
    this.size = [width / this.density, height / this.density];
    Object.assign(canvas.style, { width: `${this.size[0]}px`, height: `${this.size[1]}px` });
  }

  play(refresh, signal, onBegin) {
    const play = new Play(refresh, this.duration);
    const draw = (milliseconds) => this.draw(milliseconds / 1000);
    return showFrames(play, { draw, clear: () => this.clear(), signal, onBegin });
  }

  clear() {
    Object.assign(this, { time: null, seen: null });
    this.context.setTransform(1, 0, 0, 1, 0, 0);
    this.context.fillStyle = "#000";
    this.context.fillRect(0, 0, this.canvas.width, this.canvas.height);
  }

  /** Draw what is to be seen at a time in seconds, and remember it in pixels to the right and up from the middle. */
  draw(time) {
    this.clear();
    const { context, density, size } = this;
    this.time = time;
    this.seen = this.figure.at(time).map((meters) => meters * this.pixels);
    context.setTransform(density, 0, 0, -density, (density * size[0]) / 2, (density * size[1]) / 2);
    if (this.task.figure === "dots") this.drawDots();
    else this.drawSticks();
  }

  drawDots() {
    for (let i = 0; i < this.seen.length; i += 2) this.disc(i, this.dot, DOTS);
  }

  drawSticks() {
    const { context, seen, pixels } = this;
    const { sticks, markers, height } = this.figure.motion;
    context.strokeStyle = STICKS;
    context.lineCap = "round";
    context.lineWidth = STICK * height * pixels;
    context.beginPath();
    for (const [from, to] of sticks) {
      context.moveTo(seen[2 * from], seen[2 * from + 1]);
      context.lineTo(seen[2 * to], seen[2 * to + 1]);
    }
    context.stroke();
    const head = markers.indexOf("head");
    if (head >= 0) this.disc(2 * head, (HEAD * height * pixels) / 2, STICKS);
  }

  disc(at, radius, color) {
    const { context } = this;
    context.beginPath();
    context.arc(this.seen[at], this.seen[at + 1], radius, 0, 2 * Math.PI);
    context.fillStyle = color;
    context.fill();
  }
}
