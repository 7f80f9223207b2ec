// Stands in for VS Code: starts the extension in a folder with one specification open, and prints what a person would see.
//
//     node vscode.js EXTENSION SPECIFICATION SETTINGS
//
// SETTINGS is JSON. Printed are lines of JSON: `message`, `diagnostics`, `opened`, … . A line on stdin is a click on the first
// lens. The extension is stopped when stdin ends, or after a minute.
const fs = require("node:fs");
const Module = require("node:module");
const path = require("node:path");
const readline = require("node:readline");
const { pathToFileURL } = require("node:url");

const [extension, specification, settings] = process.argv.slice(2);
const tell = (seen) => console.log(JSON.stringify(seen));

/** Whatever nobody looks at: it can be called, constructed, extended and asked for anything. */
function anything() {
  return new Proxy(class {}, {
    apply: anything,
    get: (target, key) => (key in target ? target[key] : typeof key === "symbol" || key === "then" ? undefined : anything()),
  });
}

function withRest(known) {
  return new Proxy(known, { get: (target, key) => (key in target ? target[key] : anything()) });
}

class EventEmitter {
  listeners = new Set();
  event = (listener) => {
    this.listeners.add(listener);
    return { dispose: () => this.listeners.delete(listener) };
  };
  fire = (value) => this.listeners.forEach((listener) => listener(value));
  dispose = () => this.listeners.clear();
}

class CancellationTokenSource {
  token = { isCancellationRequested: false, onCancellationRequested: new EventEmitter().event };
  cancel() {}
  dispose() {}
}

class Uri {
  constructor(text) {
    this.text = text;
    this.fsPath = this.path = decodeURIComponent(new URL(text).pathname);
    this.scheme = new URL(text).protocol.slice(0, -1);
  }
  static parse = (text) => new Uri(text);
  static file = (name) => new Uri(pathToFileURL(name).href);
  toString = () => this.text;
}

const ranges = {
  Position: class {
    constructor(line, character) {
      Object.assign(this, { line, character });
    }
  },
  Range: class {
    constructor(...places) {
      Object.assign(this, { places });
    }
  },
  CodeLens: class {
    constructor(range, command) {
      Object.assign(this, { range, command });
    }
  },
};

const registered = { commands: {}, lenses: undefined };

const document = {
  uri: Uri.file(specification),
  fileName: specification,
  languageId: "ltlc",
  version: 1,
  isClosed: false,
  getText: () => fs.readFileSync(specification, "utf8"),
};

const vscode = withRest({
  version: "1.91.0",
  EventEmitter,
  CancellationTokenSource,
  Uri,
  ...ranges,
  Disposable: class {
    constructor(dispose = () => {}) {
      this.dispose = dispose;
    }
  },
  Diagnostic: class {
    constructor(range, message, severity) {
      Object.assign(this, { range, message, severity });
    }
  },
  DiagnosticSeverity: { Error: 0, Warning: 1, Information: 2, Hint: 3 },
  LogLevel: { Off: 0, Trace: 1, Debug: 2, Info: 3, Warning: 4, Error: 5 },
  env: withRest({ language: "en", appName: "stand-in", openExternal: async (uri) => tell({ opened: `${uri}` }) || true }),
  commands: withRest({
    executeCommand: async (...what) => tell({ executed: what }),
    registerCommand: (name, action) => withRest({ name: (registered.commands[name] = action) && name }),
  }),
  languages: withRest({
    registerCodeLensProvider: (selector, provider) => withRest({ provider: (registered.lenses = provider) }),
    match: (selector, candidate) => ([selector].flat().some(({ language }) => language === candidate.languageId) ? 10 : 0),
    createDiagnosticCollection: () =>
      withRest({ set: (uri, found) => tell({ diagnostics: found?.map(({ code, message }) => [code?.value ?? code, message]) }) }),
  }),
  window: withRest({
    showErrorMessage: async (message, ...buttons) => tell({ message }) || buttons[0],
    createOutputChannel: () => withRest({ error: (text) => console.error(text), append: (text) => console.error(text) }),
    visibleTextEditors: [],
    tabGroups: withRest({ all: [] }),
  }),
  workspace: withRest({
    workspaceFolders: [{ uri: Uri.file(path.dirname(specification)), name: "folder", index: 0 }],
    textDocuments: [document],
    notebookDocuments: [],
    getConfiguration: () => ({ get: (key, otherwise) => JSON.parse(settings)[key] ?? otherwise }),
  }),
});

const load = Module._load;
Module._load = (request, ...rest) => (request === "vscode" ? vscode : load(request, ...rest));

async function click() {
  const [lens] = await registered.lenses.provideCodeLenses(document, new CancellationTokenSource().token);
  tell({ lens: lens.command.title });
  await registered.commands[lens.command.command](...lens.command.arguments);
}

async function main() {
  const { activate, deactivate } = require(extension);
  await activate({ subscriptions: [] });
  tell({ activated: true });
  setTimeout(() => process.exit(1), 60_000).unref();
  for await (const _ of readline.createInterface(process.stdin)) await click();
  await deactivate();
  tell({ deactivated: true });
}

main();
