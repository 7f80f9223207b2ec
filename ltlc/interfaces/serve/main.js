// The page: a text and a run, and what is asked about them whenever one of them changes.

import { ask, giveUp, Superseded } from "./ask.js";
import { colouring } from "./colours.js";
import { showComparison, tellEncoding } from "./comparison.js";
import { Curves } from "./curves.js";
import { $, badge, later, make, VERDICTS, words } from "./dom.js";
import { Editor } from "./editor.js";
import { markHere, showFindings, summary } from "./findings.js";
import { History } from "./history.js";
import { keep, kept } from "./link.js";
import { showCard, showExplanation, showMachine, showMaps, showProperties, showReason } from "./properties.js";
import { MOST_STEPS, Run, WAVES } from "./run.js";
import { RunTable } from "./table.js";

const RECORDING = /\.(mcap|db3|bag|ulg|parquet|(csv|jsonl|ndjson)(\.gz|\.zst)?)$/i;

const run = new Run();
const editor = new Editor($("text"), document.querySelector(".marks"), textEdited, cursorMoved);
const table = new RunTable($("table"), run, { edited: (what) => runEdited(what, curves), reshaped: rowsEdited, chose, failed });
const curves = new Curves($("curves"), run, { edited: (what) => runEdited(what, table), chose });
const edits = new History(state, showState, showUndo);

let start, findings = [], properties = [], judged = null, rate = null, chosen = 0, at = null, shape = "", isStale = true, isNew = true;
const labels = () => properties.map((property) => property.label);
const question = (more = {}) => ({ text: editor.text, encoding: $("encoding").value, property: chosen, ...more });

// --- the text ---

const checkSoon = later(80, () => check());
const analyseSoon = later(500, () => check(true));

function textEdited() {
  textChanged();
  edits.edited(editor);
}

function textChanged() {
  $("state").textContent = "reading…";
  for (const kind of ["analyses", "judge", "explain", "compare"]) giveUp(kind);
  findings = [];
  checkSoon();
  analyseSoon();
}

async function check(analyses = false) {
  if (analyses) $("state").textContent = `${summary(findings)}; analysing…`;
  const answer = await answered("check", question({ analyses }), analyses ? "analyses" : "check");
  if (!answer) return;
  findings = answer.diagnostics;
  editor.mark(findings);
  showFindings($("findings"), findings, editor, load);
  $("state").textContent = summary(findings) + (analyses || !answer.properties ? "" : "; analysing…");
  markHere($("findings"), findings, editor);
  if (!analyses) take(answer);
}

// Take the properties and signals of a text; of one with errors, those of the text before stay, but no verdicts.
function take(answer) {
  isStale = !answer.properties;
  document.body.classList.toggle("stale", isStale);
  if (answer.properties) {
    ({ properties, rate } = answer);
    run.use(answer.signals);
    if (!run.rows.length) run.blank(Number($("count").value), rate ? 1 / rate : Number($("every").value));
    chosen = Math.max(0, Math.min(chosen, properties.length - 1));
    reshapeIfOther(JSON.stringify([labels(), answer.signals]));
    showAll();
    askMore();
  } else {
    if (!shape) reshaped();
    tell(null);
  }
  edits.settle();
  keepSoon();
}

function reshapeIfOther(now) {
  if (shape === now) return judgeSoon();
  shape = now;
  judged = null;
  return reshaped();
}

function cursorMoved() {
  markHere($("findings"), findings, editor);
  const here = properties.findIndex((property) => editor.holds(property.span));
  if (here >= 0 && here !== chosen) choose(here);
}

function choose(number) {
  isNew = false;
  chosen = number;
  showAll();
  judgeSoon();
  askMore();
}

// --- the run ---

const judgeSoon = later(60, judge);
const keepAll = () => keep({ text: editor.text, encoding: $("encoding").value, rows: run.current });
const keepSoon = later(400, keepAll);

// Somebody has changed cells; `other` shows them, too.
function runEdited(what, other) {
  edits.edited(what);
  other.refresh();
  judgeSoon();
  keepSoon();
}

function rowsEdited() {
  edits.edited();
  reshaped();
}

// The rows, or the signals, are others than before.
function reshaped() {
  if (at !== null && at >= run.rows.length) at = null;
  if (run.rows.length) $("count").value = run.rows.length;
  table.draw(labels());
  curves.draw(labels());
  offerSignals();
  chose(at);
  keepSoon();
}

// The monitor is shown as it is after the step `number`.
function chose(number) {
  at = number;
  table.choose(at);
  curves.choose(at);
  judgeSoon();
}

function load(steps) {
  run.load(steps, rate);
  tellOpened();
  at = null;
  rowsEdited();
  $("run-title").scrollIntoView({ block: "nearest" });
}

async function judge() {
  if (isStale) return;
  const answer = await answered("judge", runQuestion($("encoding").value), "judge", (error) => {
    tell(null);
    remark("error", error.message);
  });
  if (!answer) return;
  tell(answer);
  if ($("compare").open) tellEncodings();
}

function runQuestion(encoding) {
  const asked = JSON.stringify(question({ encoding, at }));
  return `${asked.slice(0, -1)}, "steps": ${run.steps()}}`;
}

// Show what the run has shown; null while that is not known.
function tell(answer) {
  judged = answer?.properties ?? null;
  $("remarks").replaceChildren();
  for (const { severity, message, help } of answer?.diagnostics ?? []) remark(severity, message, help);
  table.tell(judged?.map((property) => property.rows));
  curves.tell(judged);
  showMachine(answer?.picture ?? null, at);
  showMaps(answer?.maps ?? []);
  if (judged && isNew) chooseViolated();
  showAll();
}

// Of what has just been opened, the first property that is violated is the one to look at.
function chooseViolated() {
  isNew = false;
  const violated = judged.findIndex((property) => property.verdict === "violated");
  if (violated >= 0 && violated !== chosen) choose(violated);
}

function remark(severity, message, help = "") {
  $("remarks").append(remarked(severity, message, help));
}

function remarked(severity, message, help = "") {
  return make("p", { class: `remark ${severity}` }, make("strong", {}, `${severity} `), message, " ", help ?? "");
}

// What is to be said of the recording that is opened; nothing once the run has another source.
function tellOpened(severity, message) {
  $("opened").replaceChildren(...(message ? [remarked(severity, message)] : []));
}

function showAll() {
  showProperties(properties, judged?.map((property) => property.verdict), chosen, choose);
  showCard(properties[chosen]);
  showReason(judged?.[chosen]);
}

// --- more about the property that is chosen, if somebody wants to know ---

const askMore = later(300, () => {
  if ($("explain").open) explain();
  if ($("compare").open) compare();
});

const explain = () => fillAnswer("explain", (element, answer) => showExplanation(element, answer, load));

async function compare() {
  await fillAnswer("compare", (element, answer) => showComparison(element, answer, load));
  tellEncodings();
}

const shownFor = new Map();

// Ask about the property that is chosen, unless the answer is there already.
async function fillAnswer(name, show) {
  const element = $(name).querySelector(".answer");
  const asked = JSON.stringify(question());
  if (isStale || shownFor.get(name) === asked) return;
  shownFor.set(name, asked);
  element.replaceChildren(make("p", { class: "note" }, "working…"));
  const answer = await answered(name, asked, name, (error) => element.replaceChildren(
    make("p", { class: "note" }, error.message)));
  if (answer) show(element, answer);
  else if (shownFor.get(name) === asked) shownFor.delete(name);
}

function tellEncodings() {
  const element = $("compare").querySelector(".answer");
  for (const name of [...element.querySelectorAll("[data-encoding]")].map((each) => each.dataset.encoding)) {
    answered("judge", runQuestion(name), `judge as ${name}`, () => tellEncoding(element, name, null))
      .then((answer) => { if (answer) tellEncoding(element, name, answer.properties?.[chosen]?.verdict); });
  }
}

// --- the rest ---

// The answer to a question; nothing if another one has been asked since, or if there is none: then people are told.
async function answered(what, asked, kind = what, refused = failed) {
  try {
    return await ask(what, asked, kind);
  } catch (error) {
    if (!(error instanceof Superseded)) refused(error);
    return null;
  }
}

function failed(error) {
  $("state").textContent = error.message;
}

function open({ text, encoding = start.encodings[0], rows = [] }) {
  chosen = 0;
  at = null;
  isNew = true;
  showState({
    text,
    encoding: start.encodings.includes(encoding) ? encoding : start.encodings[0],
    rows: rows.map(({ time, cells }) => ({ time: String(time), cells: { ...cells } })),
  });
  edits.edited();
}

// What can be undone. Cells of signals that are gone belong to it: these may come back.
function state() {
  return { text: editor.text, encoding: $("encoding").value, rows: run.rows };
}

function showState({ text, encoding, rows }) {
  editor.text = text;
  $("encoding").value = encoding;
  run.rows = rows;
  tellOpened();
  isStale = true; // until the text is read
  reshaped();
  shape = "";
  textChanged();
}

function showUndo() {
  $("undo").disabled = !edits.past.length;
  $("redo").disabled = !edits.future.length;
}

// Browsers undo in one field only, and forget when a script changes it; the fields beside buttons are left to them.
function undoKey(event) {
  const key = event.key.toLowerCase();
  if (!(event.ctrlKey || event.metaKey) || event.altKey || !["z", "y"].includes(key)) return;
  if (event.target.closest("dialog, .tools input")) return;
  event.preventDefault();
  if (key === "y" || event.shiftKey) edits.redo();
  else edits.undo();
}

function openExample({ text, run: csv }) {
  run.paste(csv);
  open({ text, rows: run.rows });
}

function paste(csv) {
  try {
    run.paste(csv);
    tellOpened();
    isNew = true;
    rowsEdited();
  } catch (error) {
    notOpened(error);
  }
}

// CSV with a column `time` is taken as if it was pasted, its times as they are.
async function openFile(file) {
  const text = /\.csv$/i.test(file.name) ? await file.text() : "";
  if (text.split("\n", 1)[0].split(",").some((cell) => cell.trim() === "time")) paste(text);
  else if (RECORDING.test(file.name)) openRecording(file);
  else notOpened(new Error(`${file.name} is not a recording: open a .mcap, .db3, .bag, .ulg, .csv, .jsonl or .parquet`));
}

function notOpened(error) {
  tellOpened("error", error.message);
}

// Take the run from a recording, which is sent to the server in base64, and kept nowhere.
async function openRecording(file) {
  if (file.size > start.most) {
    return notOpened(new Error(`${file.name} is larger than ${start.most / 1e6} MB: use ltlc run`));
  }
  tellOpened("note", `opening ${file.name}…`);
  const content = await base64(file).catch(notOpened);
  if (content === undefined) return;
  const answer = await answered("open", question({ file: file.name, content }), "open", notOpened);
  if (!answer) return;
  if (!answer.rows) return notOpened(new Error(answer.diagnostics.map(({ message, help }) => [message, help].filter(Boolean).join(": ")).join("; ")));
  run.rows = answer.rows;
  tellOpened("note", answer.remark);
  isNew = true;
  at = null;
  rowsEdited();
}

function base64(file) {
  return new Promise((resolve, reject) => {
    const reader = new FileReader();
    reader.addEventListener("load", () => resolve(reader.result.replace(/^.*,/, "")));
    reader.addEventListener("error", () => reject(reader.error));
    reader.readAsDataURL(file);
  });
}

function even() {
  const count = Math.min(Math.max(1, Math.trunc(Number($("count").value)) || 1), MOST_STEPS);
  const every = Number($("every").value);
  if (!(every > 0)) return;
  run.even(count, every);
  rowsEdited();
}

// Offer the signals that can be filled; the one that was chosen stays, if it is still there.
function offerSignals() {
  const names = run.drawable.map(({ name }) => name), before = $("fill-signal").value;
  $("fill").hidden = !names.length;
  $("fill-signal").replaceChildren(...names.map((name) => make("option", {}, name)));
  if (names.includes(before)) $("fill-signal").value = before;
}

function fill() {
  const signal = run.drawable.find(({ name }) => name === $("fill-signal").value);
  run.fill(signal, $("wave").value, Number($("fill-from").value), Number($("fill-to").value));
  rowsEdited();
}

async function copy(button, text) {
  const said = button.textContent;
  await navigator.clipboard.writeText(text).then(() => { button.textContent = "Copied"; },
    () => { button.textContent = "Copying not allowed"; });
  setTimeout(() => { button.textContent = said; }, 1500);
}

function listen() {
  $("examples").addEventListener("change", () => {
    openExample(start.examples[$("examples").value]);
    $("examples").value = "";
  });
  $("encoding").addEventListener("change", () => {
    textChanged();
    edits.edited();
  });
  $("undo").addEventListener("click", () => edits.undo());
  $("redo").addEventListener("click", () => edits.redo());
  document.addEventListener("keydown", undoKey);
  $("even").addEventListener("click", even);
  $("fill").addEventListener("submit", (event) => {
    event.preventDefault();
    fill();
  });
  $("copy").addEventListener("click", () => copy($("copy"), run.csv()));
  $("share").addEventListener("click", () => {
    if (keepAll()) copy($("share"), location.href);
    else failed(new Error("too long for a link: copy the text and the CSV instead"));
  });
  $("paste").addEventListener("click", () => $("csv").showModal());
  $("csv").addEventListener("close", () => {
    if ($("csv").returnValue !== "take") return;
    paste($("csv-text").value);
  });
  document.addEventListener("dragover", (event) => {
    if (event.dataTransfer.types.includes("Files")) event.preventDefault(); // otherwise the file takes the place of the page
  });
  document.addEventListener("drop", (event) => {
    const [file] = event.dataTransfer.files;
    if (!file) return;
    event.preventDefault();
    openFile(file);
  });
  $("open").addEventListener("click", () => $("file").click());
  $("file").addEventListener("change", () => {
    const [file] = $("file").files;
    if (file) openFile(file);
    $("file").value = ""; // the same file may be opened again
  });
  for (const [name, act] of [["explain", explain], ["compare", compare]]) {
    $(name).addEventListener("toggle", () => { if ($(name).open) act(); });
  }
  window.addEventListener("hashchange", () => { if (kept()) open(kept()); });
}

async function begin() {
  start = await (await fetch("start.json")).json();
  editor.colours = colouring(start.words);
  if (start.name) $("title").textContent = start.name;
  $("version").textContent = `ltlc ${start.version}. Nothing leaves this machine.`;
  $("examples").replaceChildren(make("option", { value: "" }, "Choose…"),
    ...start.examples.map(({ title }, n) => make("option", { value: n }, title)));
  $("encoding").replaceChildren(...start.encodings.map((name) => make("option", { value: name }, name)));
  $("wave").replaceChildren(...Object.keys(WAVES).map((name) => make("option", {}, name)));
  $("legend").replaceChildren(...VERDICTS.flatMap((verdict) => [badge(verdict, true), ` ${words(verdict)} `]));
  listen();
  if (kept()) open(kept());
  else if (start.text) open({ text: start.text });
  else openExample(start.examples[0]);
}

begin();
