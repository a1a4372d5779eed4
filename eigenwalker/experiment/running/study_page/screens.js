// Screens of words. Texts of the study are only ever set as text, never as HTML.

/** The markup of a template, as text for jsPsych: none of the study's words are in it. */
export const markupOf = (name) => document.querySelector(`#${name}`).innerHTML;

/** Paragraphs, which blank lines separate. */
export function writeText(element, text) {
  const paragraphs = text.split(/\n\s*\n/).filter((paragraph) => paragraph.trim());
  element.replaceChildren(
    ...paragraphs.map((words) => Object.assign(document.createElement("p"), { textContent: words.trim() })),
  );
}

/** How far one is, in words. */
export const progressWords = (done, count) => {
  if (done === 0) return `${count} to answer`;
  return done < count ? `${done} of ${count} answered` : `all ${count} answered`;
};

/** Click on a button, once. */
export const clicked = (button) => new Promise((resolve) => button.addEventListener("click", resolve, { once: true }));

export class Screens {
  constructor(root, save) {
    Object.assign(this, { root, save, element: root.querySelector(".screen") });
    this.alert = root.querySelector(".alert");
    this.alert.querySelector(".download").addEventListener("click", save);
  }

  /** Show a screen in place of the one before. */
  show(name) {
    this.element.replaceChildren(document.querySelector(`#${name}`).content.cloneNode(true));
    const download = this.element.querySelector(".download");
    download?.addEventListener("click", this.save);
    const heading = this.element.querySelector("h1");
    heading.tabIndex = -1;
    heading.focus();
    scrollTo(0, 0);
    return (selector) => this.element.querySelector(selector);
  }

  clear() {
    this.element.replaceChildren();
  }

  /** Say above everything what is wrong. */
  warn(words, { canDownload = true } = {}) {
    this.alert.querySelector(".words").textContent = words;
    this.alert.querySelector(".download").hidden = !canDownload;
    this.alert.hidden = words === "";
    this.root.style.setProperty("--top", `${this.alert.offsetHeight}px`); // what is below makes room
  }

  /** Who takes part: a number that is given, or one of a list. Returns it when the participant goes on. */
  async welcome({ title, given, problem, count, progress, choose }) {
    const find = this.show("welcome");
    const [list, go, download, who] = ["#participant", ".go", ".download", ".who"].map(find);
    find(".title").textContent = title;
    const words = (number) => progressWords(...progress(number));
    const show = (number) => {
      choose(number);
      download.hidden = !(progress(number)?.[0] > 0);
      go.disabled = number === null;
    };
    if (given) who.textContent = `You are participant ${given}: ${words(given)}.`;
    else {
      who.textContent = problem;
      const numbers = Array.from({ length: count }, (_, i) => i + 1);
      const first = new Option("Choose your number", "", true, true);
      list.append(first, ...numbers.map((number) => new Option(`${number} – ${words(number)}`, number)));
      list.addEventListener("change", () => show(Number(list.value) || null));
    }
    find(".choose").hidden = given !== null;
    show(given);
    await clicked(go);
    return given ?? Number(list.value);
  }

  /** Returns when the participant has agreed, and when that was. */
  async consent(title, text) {
    const find = this.show("consent");
    find(".title").textContent = title;
    writeText(find(".text"), text);
    await clicked(find(".go"));
    return new Date().toISOString();
  }

  /** Go to full screen, if the browser allows it, and measure the screen. */
  async ready(measure) {
    const find = this.show("ready");
    const [go, stay] = [find(".go"), find(".window")];
    const wantsAll = await Promise.race([clicked(go).then(() => true), clicked(stay).then(() => false)]);
    go.disabled = stay.disabled = true;
    if (wantsAll) await document.documentElement.requestFullscreen?.({ navigationUI: "hide" }).catch(() => {});
    find(".status").textContent = "Measuring the screen …";
    return measure();
  }

  end(words) {
    this.show("end")(".words").textContent = words;
  }
}
