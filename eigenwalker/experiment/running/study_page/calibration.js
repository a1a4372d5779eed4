// How large things are for the eye: millimetres from a card of known size, degrees from the viewing distance.
import { pixelsAcross } from "./figure.js";
import { Shelf } from "./storage.js";

const CARD = { long: 85.6, short: 53.98 }; // millimetres, ISO/IEC 7810 ID-1
const NARROW = 600; // pixels: on a phone the card stands upright
const NAME = "calibration";

/** Pixels a millimetre, and metres to the eye, as they were measured on this screen. */
export class Calibration {
  constructor(study) {
    this.shelf = new Shelf(study);
    const known = this.shelf.getJson(NAME);
    this.isKnown = known !== null && known.pixelRatio === devicePixelRatio; // else the zoom or the screen is another
    Object.assign(this, this.isKnown ? known : { pixelsPerMillimeter: 96 / 25.4, distance: null });
  }

  take(pixelsPerMillimeter, distance) {
    Object.assign(this, { pixelsPerMillimeter, distance, pixelRatio: devicePixelRatio });
    this.shelf.putJson(NAME, { pixelsPerMillimeter, distance, pixelRatio: devicePixelRatio });
  }

  /** CSS pixels from the screen to the eye; zooming changes them. */
  get eye() {
    return 1000 * this.distance * this.pixelsPerMillimeter * (this.pixelRatio / devicePixelRatio);
  }

  get pixelsPerDegree() {
    return pixelsAcross(1, this.eye);
  }
}

/** Let the participant fit a card on the screen and say how far away the eyes are; resolves when both are done. */
export function askSize(element, calibration, viewingDistance) {
  const find = (selector) => element.querySelector(selector);
  const [card, range, distance, go] = [".card", ".width", ".distance", ".go"].map(find);
  const isUpright = innerWidth < NARROW;
  const width = isUpright ? CARD.short : CARD.long;
  card.classList.toggle("upright", isUpright);
  find(".known").hidden = !calibration.isKnown;
  Object.assign(range, { min: Math.round(1.5 * width), max: Math.round(9 * width), step: 0.5 });
  range.value = calibration.pixelsPerMillimeter * width;
  distance.value = Math.round(1000 * (calibration.distance ?? viewingDistance)) / 10;
  const draw = () => {
    card.style.width = `${range.value}px`;
    range.ariaValueText = `${range.value} pixels wide`;
    go.disabled = !distance.checkValidity();
  };
  const step = (pixels) => {
    range.value = Number(range.value) + pixels;
    draw();
  };
  find(".smaller").addEventListener("click", () => step(-0.5));
  find(".larger").addEventListener("click", () => step(0.5));
  range.addEventListener("input", draw);
  distance.addEventListener("input", draw);
  draw();
  return new Promise((resolve) => {
    go.addEventListener("click", () => resolve(calibration.take(range.value / width, distance.value / 100)));
  });
}
