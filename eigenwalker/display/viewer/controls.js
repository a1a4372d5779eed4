// What is on the page for a viewer: it listens to the user, and shows the state that the viewer is in.
import { csvOf } from "./walker.js";

const STEP = 1 / 30; // seconds

/** A number as it is written in text: with its sign, and a minus as wide as a plus. */
function signed(value, digits = 1) {
  const text = Math.abs(value).toFixed(digits);
  return Number(text) === 0 ? text : `${value < 0 ? "−" : "+"}${text}`;
}

/** A, B, C ... */
const letter = (number) => String.fromCharCode(65 + number);

export class Controls {
  constructor(viewer, link) {
    Object.assign(this, { viewer, root: viewer.root, contents: viewer.contents });
    this.build(link);
    this.listen();
    this.listenToCanvas(viewer.canvas);
  }

  find(selector) {
    return this.root.querySelector(selector);
  }

  findAll(selector) {
    return [...this.root.querySelectorAll(selector)];
  }

  /** Text from outside is only ever set as text, never as HTML. */
  write(selector, text) {
    const element = this.find(selector);
    if (element.textContent !== text) element.textContent = text;
  }

  say(text) {
    this.write(".message", text);
  }

  // Building what depends on the model.

  build(link) {
    const { traits, names, kind, title, note, unit, n_harmonics: count } = this.contents;
    this.average = kind === "model" ? "Average walker" : "Average of these walks";
    this.write(".title", title);
    this.write(".note", note);
    this.find(".base").append(...[this.average, ...names].map((name, number) => new Option(name, number - 1)));
    this.find(".load").hidden = names.length === 0;
    this.find(".traits").hidden = traits.length === 0;
    this.write(".unit", `In ${unit}; bands show where your walkers are.`);
    this.rows = traits.map((trait, number) => this.buildRow(trait, number));
    this.find(".harmonics").append(...Array.from({ length: count }, (_, k) => this.buildHarmonic(k)));
    this.find(".copy").hidden = !link;
  }

  buildRow(trait, number) {
    const row = this.find(".traits template").content.cloneNode(true).firstElementChild;
    const [hold, field, range] = [".hold input", ".number", ".range"].map((name) => row.querySelector(name));
    row.querySelector(".name").textContent = trait.name;
    row.querySelector(".negative").textContent = trait.negative;
    row.querySelector(".positive").textContent = trait.positive;
    row.title = `Your walkers lie between ${signed(trait.low)} and ${signed(trait.high)}.`;
    row.style.setProperty("--low", 0.5 + (0.5 * trait.low) / trait.reach);
    row.style.setProperty("--high", 0.5 + (0.5 * trait.high) / trait.reach);
    for (const input of [range, field]) {
      Object.assign(input, { min: -trait.reach, max: trait.reach, ariaLabel: trait.name });
    }
    range.step = trait.reach / 120;
    hold.ariaLabel = `hold ${trait.name}`;
    range.addEventListener("input", () => this.viewer.setAlpha(number, Number(range.value)));
    field.addEventListener("change", () => this.enterAlpha(number, field));
    hold.addEventListener("change", () => this.viewer.setHold(number, hold.checked));
    this.find(".rows").append(row);
    return { row, hold, field, range, digits: Math.max(0, 2 - Math.floor(Math.log10(trait.reach))) };
  }

  buildHarmonic(k) {
    const label = this.find(".harmonics template").content.cloneNode(true).firstElementChild;
    const input = label.querySelector("input");
    label.querySelector("span").textContent = k + 1;
    input.ariaLabel = `harmonic ${k + 1}`;
    input.addEventListener("change", () => this.viewer.setHarmonic(k, input.checked));
    return label;
  }

  // Listening.

  listen() {
    const { viewer } = this;
    const on = (selector, kind, action) => {
      for (const element of this.findAll(selector)) element.addEventListener(kind, () => action(element));
    };
    // A notebook takes keys for itself as they bubble up, and arrow keys on sliders are not for it.
    this.root.addEventListener("keydown", (event) => event.stopPropagation());
    on(".play", "click", () => viewer.play(!viewer.playing));
    on(".back", "click", () => viewer.step(-STEP));
    on(".forward", "click", () => viewer.step(STEP));
    on(".phase", "input", ({ value }) => viewer.setPhase(Number(value)));
    on(".add", "click", () => viewer.addWalker());
    on(".remove", "click", () => viewer.removeWalker());
    on(".base", "change", ({ value }) => viewer.change({ walker: value < 0 ? null : Number(value), held: new Map() }));
    on(".reset", "click", () => viewer.change({ held: new Map(), part: null }));
    on(".part input", "change", ({ value }) => viewer.change({ part: value || null }));
    on("[data-azimuth]", "click", ({ dataset }) => viewer.turn(Number(dataset.azimuth), 0));
    on("[data-zoom]", "click", ({ dataset }) => viewer.setScene({ zoom: viewer.scene.zoom * dataset.zoom }));
    on("[data-scene]", "input", (input) => {
      viewer.setScene({ [input.dataset.scene]: input.type === "checkbox" ? input.checked : Number(input.value) });
    });
    on(".shuffle", "click", () => viewer.setScene({ seed: viewer.scene.seed + 1 }));
    on(".png", "click", () => this.savePicture());
    on(".csv", "click", () => this.saveTable());
    on(".copy", "click", () => this.copyLink());
  }

  /** Turn by drag and by keys; a click selects a walker. */
  listenToCanvas(canvas) {
    const { viewer } = this;
    let drag = null;
    canvas.addEventListener("pointerdown", (event) => {
      drag = { x: event.clientX, y: event.clientY, from: { ...viewer.scene }, moved: false };
      canvas.setPointerCapture(event.pointerId);
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!drag) return;
      const [right, down] = [event.clientX - drag.x, event.clientY - drag.y];
      drag.moved ||= Math.hypot(right, down) > 4;
      if (drag.moved) viewer.turn(drag.from.azimuth + 0.5 * right, drag.from.elevation + 0.3 * down);
    });
    canvas.addEventListener("pointerup", (event) => {
      if (drag && !drag.moved) viewer.selectAt(event.offsetX, event.offsetY);
      drag = null;
    });
    canvas.addEventListener("pointercancel", () => (drag = null));
    canvas.addEventListener("keydown", (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || !this.press(event.key, event.shiftKey ? 1 : 5)) return;
      event.preventDefault();
    });
  }

  /** Do what a key on the canvas stands for, and return whether it stands for anything. */
  press(key, angle) {
    const { viewer } = this;
    const { azimuth, elevation, zoom } = viewer.scene;
    const actions = {
      ArrowLeft: () => viewer.turn(azimuth - angle, elevation),
      ArrowRight: () => viewer.turn(azimuth + angle, elevation),
      ArrowUp: () => viewer.turn(azimuth, elevation + angle),
      ArrowDown: () => viewer.turn(azimuth, elevation - angle),
      "+": () => viewer.setScene({ zoom: 1.1 * zoom }),
      "-": () => viewer.setScene({ zoom: zoom / 1.1 }),
      " ": () => viewer.play(!viewer.playing),
      ",": () => viewer.step(-STEP),
      ".": () => viewer.step(STEP),
    };
    actions[key]?.();
    return key in actions;
  }

  enterAlpha(trait, field) {
    const { name, reach } = this.contents.traits[trait];
    const alpha = field.value.trim() === "" ? NaN : Number(field.value);
    if (Math.abs(alpha) <= reach) this.viewer.setAlpha(trait, alpha);
    else this.say(`${name} must be a number from ${signed(-reach)} to ${signed(reach)}.`);
    field.value = this.viewer.walker.alphas[trait].toFixed(this.rows[trait].digits);
  }

  // Showing.

  show() {
    const { scene, walker, playing } = this.viewer;
    for (const input of this.findAll("[data-scene]")) {
      input[input.type === "checkbox" ? "checked" : "value"] = scene[input.dataset.scene];
    }
    this.findAll(".harmonics input").forEach((input, k) => (input.checked = scene.harmonics[k]));
    for (const button of this.findAll("[data-azimuth]")) {
      button.ariaPressed = String(scene.azimuth === Number(button.dataset.azimuth) && scene.elevation === 0);
    }
    for (const radio of this.findAll(".part input")) radio.checked = radio.value === (walker.part ?? "");
    this.write(".speed-value", `${scene.speed.toFixed(2)}×`);
    this.find(".play").ariaLabel = playing ? "Pause" : "Play";
    this.find(".play").classList.toggle("playing", playing);
    this.find(".base").value = walker.walker ?? -1;
    this.showChips();
    this.rows.forEach((row, trait) => this.showRow(row, trait));
    this.showWords();
    this.showPhase();
  }

  showChips() {
    const { viewer } = this;
    const chips = this.find(".chips");
    while (chips.children.length > viewer.walkers.length) chips.lastChild.remove();
    while (chips.children.length < viewer.walkers.length) {
      const number = chips.children.length;
      const words = { type: "button", textContent: letter(number), ariaLabel: `Walker ${letter(number)}` };
      const chip = Object.assign(document.createElement("button"), words);
      chip.addEventListener("click", () => viewer.select(number));
      chips.append(chip);
    }
    [...chips.children].forEach((chip, number) => (chip.ariaPressed = String(number === viewer.selected)));
    this.find(".add").disabled = !viewer.canAdd;
    this.find(".remove").disabled = viewer.walkers.length === 1;
  }

  showRow({ row, hold, field, range, digits }, trait) {
    const { walker } = this.viewer;
    const { name, negative, positive, low, high } = this.contents.traits[trait];
    const alpha = walker.alphas[trait];
    const isHeld = walker.held.has(trait);
    const isBeyond = alpha < low - 1e-9 || alpha > high + 1e-9;
    const side = Math.abs(alpha) < 0.005 ? "average" : alpha < 0 ? negative : positive;
    range.value = alpha;
    range.ariaValueText = `${signed(alpha, digits)}, ${side}${isBeyond ? ", beyond your walkers" : ""}`;
    if (field !== field.getRootNode().activeElement) field.value = alpha.toFixed(digits);
    hold.checked = isHeld;
    hold.closest("label").title = `${name} ${isHeld ? "stays here" : "goes along with the others"}`;
    row.classList.toggle("held", isHeld);
    row.classList.toggle("beyond", isBeyond);
  }

  /** What walkers are called, and what must be said of them. */
  showWords() {
    const { walkers, walker, scene } = this.viewer;
    walkers.forEach((one, number) => this.nameWalker(one, number, walkers.length > 1));
    this.write(".warning", this.warningsOf(walker).join(" "));
    const isLoaded = this.contents.kind === "model" && walker.walker !== null;
    const { n_components: count } = this.contents;
    const shown = `Shown as its ${count} Eigenwalkers show it; what they leave out is not in this page.`;
    this.write(".loaded", isLoaded ? shown : "");
    const tempo = [walker.frequency.toFixed(2), (120 * walker.frequency).toFixed(0)];
    this.write(".tempo", `${tempo[0]} strides a second, ${tempo[1]} steps a minute`);
    const said = walkers.map(({ title, caption }) => (caption ? `${title}: ${caption}` : title)).join("; ");
    const angles = `${scene.azimuth.toFixed(0)} degrees, ${scene.elevation.toFixed(0)} degrees up`;
    this.find("canvas").ariaLabel = `${said}; seen from ${angles}. Arrow keys turn the view, space plays and pauses.`;
  }

  nameWalker(walker, number, isOneOfMany) {
    const { names, traits } = this.contents;
    const name = walker.walker === null ? this.average : names[walker.walker];
    const called = walker.walker === null ? letter(number) : `${letter(number)}  ${name}`;
    const held = [...walker.held].map(([trait, alpha]) => `${traits[trait].name} ${signed(alpha)}`);
    walker.title = isOneOfMany ? called : name;
    walker.caption = [...(this.viewer.isOutside(walker) ? ["outside your data"] : []), ...held].join(", ");
  }

  warningsOf(walker) {
    const warnings = [];
    if (this.viewer.isOutside(walker)) {
      const [far, limit] = [walker.distance, this.contents.distance_limit].map((value) => value.toFixed(1));
      const who = `99 % of walkers like yours are within ${limit}`;
      warnings.push(`Outside your data: ${far} standard deviations from the average walker; ${who}.`);
    }
    if (!(walker.frequency > 0)) warnings.push("No walk lies that far out: its frequency is not above zero.");
    return warnings;
  }

  showPhase() {
    const degrees = Math.round((this.viewer.walker.phase * 180) / Math.PI) % 360;
    this.find(".phase").value = degrees;
    this.write(".phase-value", `${degrees}°`);
  }

  // Taking something home.

  save(blob, name) {
    const anchor = Object.assign(document.createElement("a"), { href: URL.createObjectURL(blob), download: name });
    anchor.click();
    setTimeout(() => URL.revokeObjectURL(anchor.href), 10_000);
  }

  savePicture() {
    const { stage, walkers, scene, canvas } = this.viewer;
    stage.draw(walkers, scene); // without the mark at the selected walker
    canvas.toBlob((blob) => this.save(blob, "walker.png"));
    this.viewer.wake();
  }

  /** The markers of the selected walker, without scramble and mask. */
  saveTable() {
    const { walker, scene } = this.viewer;
    if (!(walker.frequency > 0)) this.say("There is no walk to save: its frequency is not above zero.");
    else this.save(new Blob([csvOf(walker, scene.harmonics)], { type: "text/csv" }), "walker.csv");
  }

  async copyLink() {
    const field = this.find(".address");
    field.value = this.viewer.link;
    field.hidden = false;
    field.select();
    try {
      await navigator.clipboard.writeText(field.value);
      this.say("The link is copied.");
    } catch {
      this.say("Copy the link from the field.");
    }
  }
}
