// Pictures of walkers on a canvas.
import { randomNumbers } from "./walker.js";

const SHADES = 16;
const ROOM = { top: 44, label: 44 }; // pixels over all walkers, and under each
const BODY = { high: 1.25, wide: 0.78 }; // room for a body, in heights of its head
const NARROW = 560; // pixels: what is over the stage would cover a walker
const EYE = 4.5; // metres between the eye and the middle of the body, in perspective
const BELT = { long: 1.3, wide: 0.4, step: 0.4 }; // metres: half its length and width, and between its marks

/** What an observer sees: to the right, up, near, and size; from azimuth 0 before the walker, from 90 at its right. */
export function makeCamera({ azimuth, elevation, perspective }) {
  const [turn, tilt] = [azimuth, elevation].map((degrees) => (Math.PI * degrees) / 180);
  const [sinTurn, cosTurn, sinTilt, cosTilt] = [Math.sin(turn), Math.cos(turn), Math.sin(tilt), Math.cos(tilt)];
  return (x, y, z, seen, at) => {
    const level = x * cosTurn - y * sinTurn;
    const near = level * cosTilt + z * sinTilt;
    const size = perspective ? EYE / Math.max(EYE - near, 0.3) : 1;
    seen[at] = (x * sinTurn + y * cosTurn) * size;
    seen[at + 1] = (z * cosTilt - level * sinTilt) * size;
    seen[at + 2] = near;
    seen[at + 3] = size;
  };
}

/** Cells of equal size, in which bodies come out as large as they can; all in pixels, the body's height in metres. */
export function layOut(count, width, height, { body, top = 0, label, zoom }) {
  const plans = Array.from({ length: count }, (_, i) => {
    const rows = Math.ceil(count / (i + 1));
    const cell = { width: width / (i + 1), height: (height - top) / rows };
    return {
      columns: i + 1,
      cell,
      scale: Math.min((cell.height - label) / (BODY.high * body), cell.width / (BODY.wide * body)),
    };
  });
  const { columns, cell, scale } = plans.reduce((one, other) => (other.scale > 1.001 * one.scale ? other : one));
  return Array.from({ length: count }, (_, i) => {
    const row = Math.floor(i / columns);
    const inRow = Math.min(columns, count - row * columns); // the last row stands in the middle
    const left = (width - inRow * cell.width) / 2 + (i % columns) * cell.width;
    const upper = top + row * cell.height;
    const middle = { x: left + cell.width / 2, y: upper + (cell.height - label) / 2 };
    return { left, top: upper, ...cell, ...middle, scale: scale * zoom };
  });
}

/** Colors from far to near, between two that are written #rrggbb. */
function shades(far, near) {
  const [first, last] = [far, near].map((color) => [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16)));
  return Array.from({ length: SHADES }, (_, shade) => {
    const mixed = first.map((value, i) => Math.round(value + (shade / (SHADES - 1)) * (last[i] - value)));
    return `rgb(${mixed.join(" ")})`;
  });
}

/** Draws walkers in cells side by side, all seen by the same camera. */
export class Stage {
  constructor(canvas, space) {
    Object.assign(this, { canvas, space, context: canvas.getContext("2d", { alpha: false }), cells: [], chance: {} });
    const { markers, sticks } = space.contents;
    this.sides = markers.map((name) => /^(left|right)_/.exec(name)?.[1] ?? "middle");
    this.sticks = sticks.map(([from, to]) => {
      return { from, to, side: this.sides[from] === this.sides[to] ? this.sides[from] : "middle" };
    });
    this.head = markers.indexOf("head");
    this.fitted = new Map();
  }

  /** Take the colors from the style sheet, where they follow the theme. */
  takeColors() {
    const style = getComputedStyle(this.canvas);
    const color = (name) => style.getPropertyValue(`--${name}`).trim();
    this.colors = Object.fromEntries(
      ["paper", "ink", "faint", "floor", "belt", "shadow", "mark"].map((name) => [name, color(name)]),
    );
    const inks = ["middle", "left", "right"].map((side) => [side, shades(color(`${side}-far`), color(`${side}-near`))]);
    this.inks = Object.fromEntries(inks);
    this.font = style.fontFamily;
  }

  /** Give the canvas as many pixels as the screen has, so that dense screens are sharp. */
  resize() {
    const { canvas } = this;
    const density = globalThis.devicePixelRatio || 1;
    this.size = [canvas.clientWidth, canvas.clientHeight]; // asking for it is slow, so it is not done for each frame
    const [width, height] = this.size.map((side) => Math.max(1, Math.round(side * density)));
    Object.assign(canvas, { width, height });
    this.density = density;
  }

  /** Draw walkers; `scene` says from where they are seen and how they are shown, `selected` which one is marked. */
  draw(walkers, scene, selected = -1) {
    if (this.density !== (globalThis.devicePixelRatio || 1)) this.resize();
    const { context, density } = this;
    const [width, height] = this.size;
    context.setTransform(density, 0, 0, density, 0, 0);
    context.fillStyle = this.colors.paper;
    context.fillRect(0, 0, width, height);
    const rooms = { top: walkers.length > 1 || width < NARROW ? ROOM.top : 0, label: scene.labels ? ROOM.label : 0 };
    this.cells = layOut(walkers.length, width, height, { body: this.space.height, ...rooms, zoom: scene.zoom });
    this.camera = makeCamera(scene);
    walkers.forEach((walker, number) => {
      const cell = this.cells[number];
      context.save();
      context.beginPath();
      context.rect(cell.left, cell.top, cell.width, cell.height);
      if (walkers.length > 1 && scene.zoom > 1) context.clip();
      this.drawWalker(cell, walker, scene);
      context.restore();
    });
    if (scene.labels) this.drawLabels(walkers, selected);
  }

  drawWalker(cell, walker, scene) {
    const chance = this.takeChances(scene);
    walker.pose(scene.harmonics, scene.scramblePhases ? chance.phases : null);
    const points = this.disguise(walker, scene, chance);
    const seen = this.project(cell, walker.middle, points);
    Object.assign(walker, { shown: points, seen }); // for those who want to know what was drawn
    if (scene.ground && !scene.invert) this.drawGround(cell, walker);
    this.drawBody(cell, seen, scene);
  }

  /** Random numbers between 0 and 1 for scrambles and masks, always the same ones for one seed. */
  takeChances({ mask, seed }) {
    if (this.chance.seed !== seed || this.chance.mask.length !== 4 * mask) {
      const counts = [3 * this.space.nMarkers, this.space.nMarkers, 4 * mask];
      const [places, shares, dots] = counts.map((length, use) => Array.from({ length }, randomNumbers(3 * seed + use)));
      this.chance = { seed, places, phases: shares.map((share) => 2 * Math.PI * share), mask: dots };
    }
    return this.chance;
  }

  /** The points that are shown: the walker's, elsewhere if scrambled, then the mask's; all of them upside down or not. */
  disguise(walker, scene, chance) {
    const { points, vector, space } = walker;
    const shown = new Float64Array(points.length + 3 * scene.mask);
    shown.set(points);
    if (scene.scramblePlaces) {
      const ranges = [0, 1, 2].map((axis) => space.rangeOf(vector, axis));
      for (let i = 0; i < points.length; i++) {
        const [low, high] = ranges[i % 3];
        shown[i] += low + chance.places[i] * (high - low) - vector[i];
      }
    }
    for (let i = 0; i < scene.mask; i++) {
      const dot = chance.mask.slice(4 * i, 4 * i + 4);
      this.placeMaskDot(walker, scene, i % space.nMarkers, dot, shown, points.length + 3 * i);
    }
    if (scene.invert) for (let i = 2; i < shown.length; i += 3) shown[i] = space.height - shown[i];
    return shown;
  }

  /** A dot of the mask moves like a marker, at another place and phase (after Cutting, Moore & Morrison 1988). */
  placeMaskDot({ space, vector, middle, phase }, { harmonics }, marker, [shift, x, y, z], shown, at) {
    shown[at] = middle[0] + 0.7 * (x - 0.5) * space.height;
    shown[at + 1] = middle[1] + 0.7 * (y - 0.5) * space.height;
    shown[at + 2] = 1.05 * z * space.height;
    space.addMotion(vector, marker, phase + 2 * Math.PI * shift, harmonics, shown, at);
  }

  /** Where points are in the picture: pixels to the right and down, metres near, and size; four numbers each. */
  project(cell, middle, points) {
    const seen = new Float64Array((4 * points.length) / 3);
    for (let i = 0, at = 0; i < points.length; i += 3, at += 4) {
      this.camera(points[i] - middle[0], points[i + 1] - middle[1], points[i + 2] - middle[2], seen, at);
      seen[at] = cell.x + cell.scale * seen[at];
      seen[at + 1] = cell.y - cell.scale * seen[at + 1];
    }
    return seen;
  }

  /** Sticks and dots, from far to near; a dot is before all sticks that it ends. */
  drawBody(cell, seen, scene) {
    const sticks = scene.sticks && !scene.scramblePlaces && !scene.scramblePhases ? this.sticks : [];
    const nears = Array.from({ length: seen.length / 4 }, (_, point) => seen[4 * point + 2]);
    const parts = sticks.map((stick) => ({ stick, near: (nears[stick.from] + nears[stick.to]) / 2 }));
    const fronts = nears.slice();
    for (const { stick, near } of parts) {
      for (const end of [stick.from, stick.to]) fronts[end] = Math.max(fronts[end], near);
    }
    fronts.forEach((front, point) => {
      const isDrawn = scene.dots || (sticks.length > 0 && point === this.head);
      if (isDrawn) parts.push({ point, near: front + 1e-6, depth: nears[point] });
    });
    parts.sort((one, other) => one.near - other.near);
    for (const part of parts) {
      if (part.stick) this.drawStick(cell, seen, part, scene);
      else this.drawDot(cell, seen, part, scene, sticks.length > 0);
    }
  }

  /** A color for a side of the body, the nearer the stronger. */
  inkOf(side, near, { sides, shading }) {
    const share = shading ? Math.min(1, Math.max(0, 0.5 + near / (0.55 * this.space.height))) : 1;
    const shade = Math.round((SHADES - 1) * share);
    return this.inks[sides ? side : "middle"][shade];
  }

  drawStick(cell, seen, { stick, near }, scene) {
    const { context } = this;
    const [a, b] = [4 * stick.from, 4 * stick.to];
    const width = 0.024 * this.space.height * cell.scale * 0.5 * (seen[a + 3] + seen[b + 3]);
    context.lineCap = scene.dots ? "butt" : "round"; // under a dot no one sees the end, and round ones are slow
    context.beginPath();
    context.moveTo(seen[a], seen[a + 1]);
    context.lineTo(seen[b], seen[b + 1]);
    context.strokeStyle = this.colors.paper; // a rim that lifts what is near from what is behind it
    context.lineWidth = width + Math.max(2, 0.5 * width);
    context.stroke();
    context.strokeStyle = this.inkOf(stick.side, near, scene);
    context.lineWidth = width;
    context.stroke();
  }

  drawDot(cell, seen, { point, depth }, scene, onSticks) {
    const { context } = this;
    const at = 4 * point;
    const isHead = onSticks && point === this.head;
    const radius =
      (isHead ? 0.062 : onSticks ? 0.0165 : 0.0135) * scene.dotSize * this.space.height * cell.scale * seen[at + 3];
    const fill = (color, size) => {
      context.beginPath();
      context.arc(seen[at], seen[at + 1], size, 0, 2 * Math.PI);
      context.fillStyle = color;
      context.fill();
    };
    if (onSticks) fill(this.colors.paper, radius + Math.max(1, 0.1 * radius));
    fill(this.inkOf(this.sides[point] ?? "middle", depth, scene), radius);
  }

  /** The belt of a treadmill, which runs back under the walker as fast as its feet do, and the shadows of the feet. */
  drawGround(cell, walker) {
    const { context } = this;
    const [x, y] = walker.middle;
    const long = Math.min(BELT.long, Math.max(0.7, (0.46 * cell.width) / cell.scale));
    const corners = [-long, -BELT.wide, long, -BELT.wide, long, BELT.wide, -long, BELT.wide];
    const marks = [];
    for (let at = BELT.step - long - (walker.way % BELT.step); at < long; at += BELT.step) {
      if (at > -long) marks.push(at, -BELT.wide, at, BELT.wide);
    }
    const onFloor = [];
    for (let i = 0; i < corners.length; i += 2) onFloor.push(x + corners[i], y + corners[i + 1], 0);
    for (let i = 0; i < marks.length; i += 2) onFloor.push(x + marks[i], y + marks[i + 1], 0);
    const seen = this.project(cell, walker.middle, onFloor);
    context.beginPath();
    for (let at = 0; at < 16; at += 4) context.lineTo(seen[at], seen[at + 1]);
    context.closePath();
    context.fillStyle = this.colors.belt;
    context.fill();
    for (let at = 16; at < seen.length; at += 8) {
      context.moveTo(seen[at], seen[at + 1]);
      context.lineTo(seen[at + 4], seen[at + 5]);
    }
    context.strokeStyle = this.colors.floor;
    context.lineWidth = 1;
    context.stroke();
    for (const ankle of this.space.ankles) if (ankle >= 0) this.drawShadow(cell, walker, ankle);
    context.globalAlpha = 1;
  }

  /** The shadow of a foot, weaker the higher the foot is. */
  drawShadow(cell, walker, marker) {
    const { context } = this;
    const [x, y, z] = walker.points.subarray(3 * marker, 3 * marker + 3);
    const foot = [x + 0.05, y, 0, x + 0.18, y, 0, x + 0.05, y + 0.055, 0]; // its middle, its tip, its side
    const seen = this.project(cell, walker.middle, foot);
    const [right, down] = [seen[0], seen[1]];
    context.save();
    context.transform(seen[4] - right, seen[5] - down, seen[8] - right, seen[9] - down, right, down);
    context.beginPath();
    context.arc(0, 0, 1, 0, 2 * Math.PI);
    context.restore();
    context.globalAlpha = Math.max(0, 0.34 - z);
    context.fillStyle = this.colors.shadow;
    context.fill();
  }

  /** Under each walker its name, and below what it holds. */
  drawLabels(walkers, selected) {
    const { context } = this;
    context.textAlign = "center";
    for (const [name, font, up, head] of [
      ["title", "600 14px", 26, 3], // names differ at their ends
      ["caption", "12px", 9, Infinity],
    ]) {
      context.font = `${font} ${this.font}`; // once a frame: it is slow
      this.cells.forEach((cell, number) => {
        const feet = cell.y + 0.5 * BODY.high * this.space.height * cell.scale;
        const bottom = Math.min(cell.top + cell.height, feet + ROOM.label);
        const isMarked = number === selected && walkers.length > 1;
        context.fillStyle = name === "caption" ? this.colors.faint : isMarked ? this.colors.mark : this.colors.ink;
        context.fillText(this.fit(walkers[number][name], head, cell.width - 16, font), cell.x, bottom - up);
      });
    }
  }

  /** As much of a text as there is room for: some of its head, and its end. Measuring is slow, so it is done once. */
  fit(text, head, width, font) {
    const key = `${font} ${width} ${text}`;
    if (this.fitted.size > 500) this.fitted.clear();
    if (!this.fitted.has(key)) {
      let shown = text;
      for (let kept = Math.min(text.length, 100); kept > 5 && this.context.measureText(shown).width > width; kept--) {
        shown = `${text.slice(0, Math.min(head, kept - 1))}…${text.slice(text.length - Math.max(0, kept - head))}`;
      }
      this.fitted.set(key, shown);
    }
    return this.fitted.get(key);
  }
}
