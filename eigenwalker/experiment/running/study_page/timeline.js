// What a participant goes through, as jsPsych runs it: instructions, trials, breaks.
import { markupOf, progressWords, writeText } from "./screens.js";

const SECOND_MS = 1000;
const BUTTON = '<button type="button" class="answer"></button>'; // without words: those are set as text
const CLOSED = '<button type="button" class="answer" disabled></button>';

/** The task that a row belongs to. */
export function taskOf(contents, row) {
  return contents.tasks.find(({ task, trait }) => task === row.task && (trait ?? "") === row.trait);
}

/** The rows of a participant, in order. */
export function rowsOf({ design }, participant) {
  const names = Object.keys(design);
  const rows = design.participant.flatMap((number, i) => (number === participant ? [i] : []));
  return rows.map((i) => Object.fromEntries(names.map((name) => [name, design[name][i]])));
}

/** A screen of words with one button. */
function wordsScreen(name, button, fill) {
  return {
    type: jsPsychHtmlButtonResponse,
    stimulus: markupOf(name),
    choices: ["0"],
    button_html: () => BUTTON,
    css_classes: ["plain"],
    save_trial_parameters: { stimulus: false },
    on_load: () => {
      const element = document.querySelector(".jspsych-content");
      const go = element.querySelector(".answer");
      go.textContent = button;
      fill(element);
      const heading = element.querySelector("h1");
      heading.tabIndex = -1;
      heading.focus();
    },
  };
}

/** The sessions of some rows, each with those of its rows that are not answered yet. */
function sessionsOf(rows, isAnswered) {
  const numbers = [...new Set(rows.map(({ session }) => session))];
  const sessions = numbers.map((number, i) => {
    const all = rows.filter(({ session }) => session === number);
    return { number: i + 1, count: numbers.length, all, open: all.filter((row) => !isAnswered(row)) };
  });
  return sessions.filter(({ open }) => open.length > 0);
}

/** All that is left for a participant. `runTrial` is given the element of a trial and its row. */
export function makeTimeline(contents, rows, { isAnswered, runTrial, save }) {
  const done = () => progressWords(rows.filter(isAnswered).length, rows.length);
  const sessions = sessionsOf(rows, isAnswered);
  return sessions.flatMap((session, i) => [
    ...(i > 0 ? [breakScreen(taskOf(contents, sessions[i - 1].all[0]), done, save)] : []),
    ...sessionItems(contents, session, runTrial),
  ]);
}

function breakScreen({ break_text: text }, done, save) {
  return wordsScreen("break", "Go on", (element) => {
    element.querySelector(".progress").textContent = done();
    writeText(element.querySelector(".text"), text);
    element.querySelector(".download").addEventListener("click", save);
  });
}

function sessionItems(contents, session, runTrial) {
  const items = [instructionScreen(contents, session)];
  session.open.forEach((row, i) => {
    const before = session.open[i - 1];
    if (before?.part === "practice" && row.part !== "practice") items.push(practiceEnd());
    items.at(-1).post_trial_gap = SECOND_MS * taskOf(contents, row).blank;
    items.push(trialItem(contents, session, row, runTrial));
  });
  return items;
}

function instructionScreen(contents, { number, count, open }) {
  const { title, instruction } = taskOf(contents, open[0]);
  const practice = open.filter(({ part }) => part === "practice").length;
  return wordsScreen("instruction", "Start", (element) => {
    element.querySelector(".progress").textContent = count > 1 ? `Part ${number} of ${count}` : "";
    element.querySelector(".title").textContent = title;
    writeText(element.querySelector(".text"), instruction);
    element.querySelector(".practice").textContent =
      practice > 1 ? `The first ${practice} are for practice.` : practice ? "The first one is for practice." : "";
  });
}

function practiceEnd() {
  return wordsScreen("instruction", "Go on", (element) => {
    element.querySelector(".title").textContent = "That was the practice";
    writeText(element.querySelector(".text"), "From now on your answers count.");
  });
}

function trialItem(contents, { number, count, all }, row, runTrial) {
  const task = taskOf(contents, row);
  const part = count > 1 ? `Part ${number} of ${count} · ` : "";
  const practice = row.part === "practice" ? "Practice · " : "";
  return {
    type: jsPsychHtmlButtonResponse,
    stimulus: markupOf("trial"),
    choices: task.buttons.map((_, i) => String(i)),
    button_html: () => CLOSED,
    response_ends_trial: false,
    css_classes: ["trial", task.buttons_at],
    save_trial_parameters: { stimulus: false },
    on_load: () => {
      const element = document.querySelector(".jspsych-content");
      element.querySelector(".progress").textContent = `${practice}${part}${all.indexOf(row) + 1} of ${all.length}`;
      runTrial(element, row, task);
    },
  };
}
