// Starts the language server `ltlc lsp` and connects the editor with it; what is shown is all the server's.
const { execFile } = require("node:child_process");
const { commands, window, workspace } = require("vscode");
const { CloseAction, LanguageClient } = require("vscode-languageclient/node");

/** The exit code of `ltlc` for wrong arguments, and where something is not installed. */
const UNUSABLE = 2;

/** A client that starts its server again if it dies, but not if it could not start. */
class Client extends LanguageClient {
  createDefaultErrorHandler(...limits) {
    const usual = super.createDefaultErrorHandler(...limits);
    const closed = () => (this.isRunning() ? usual.closed() : { action: CloseAction.DoNotRestart, handled: true });
    return { error: (...what) => usual.error(...what), closed };
  }
}

let client;
let last = Promise.resolve();

async function activate(context) {
  context.subscriptions.push(
    workspace.onDidChangeConfiguration((change) => {
      if (!change.affectsConfiguration("ltlc")) return;
      after(stop);
      after(start);
    }),
  );
  await after(start);
}

function deactivate() {
  return after(stop);
}

/** Do `step` when all earlier ones are done, however they ended. */
function after(step) {
  last = last.then(step, step);
  return last;
}

async function start() {
  const settings = workspace.getConfiguration("ltlc");
  const command = settings.get("path");
  const args = ["lsp", ...settings.get("arguments")];
  const options = { cwd: workspace.workspaceFolders?.[0]?.uri.fsPath };
  const shown = { documentSelector: [{ language: "ltlc" }], initializationFailedHandler: () => false };
  client = new Client("ltlc", "ltlc", { command, args, options }, shown);
  try {
    await client.start();
  } catch {
    const obstacle = await whyItDoesNotStart(command, args, options);
    // Not awaited: a message stays until it is answered.
    if (obstacle) tell(command, obstacle);
  }
}

/** What keeps the server from starting, if that can be told: it is started with nothing to read. */
function whyItDoesNotStart(command, args, options) {
  return new Promise((resolve) => {
    const server = execFile(command, args, { ...options, timeout: 10_000 }, (error, _, said) => {
      if (error?.code === UNUSABLE) resolve(said.trim().split("\n").pop());
      else resolve(typeof error?.code === "string" ? "there is no such command, or it may not be run" : undefined);
    });
    server.stdin.on("error", () => {}).end();
  });
}

async function stop() {
  const running = client;
  client = undefined;
  if (running?.isRunning()) await running.stop();
}

async function tell(command, obstacle) {
  const message =
    `\`${command} lsp\` does not start: ${obstacle}. Install ltlc with its extra \`editor\` (in its checkout: ` +
    "pip install '.[editor]'), or set `ltlc.path` to where it is.";
  const open = "Open Settings";
  if ((await window.showErrorMessage(message, open)) === open) {
    await commands.executeCommand("workbench.action.openSettings", "ltlc.path");
  }
}

module.exports = { activate, deactivate };
