// The client of `bmod lsp`, runs in a terminal, and figures in a panel.
"use strict";
const vscode = require("vscode");
const path = require("path");
const os = require("os");
const fs = require("fs");
const { execFile } = require("child_process");
const { LanguageClient } = require("vscode-languageclient/node");

let client;
let panel;

const program = () => vscode.workspace.getConfiguration("bmod").get("path") || "bmod";

async function start() {
  const server = { command: program(), args: ["lsp"] };
  const options = {
    documentSelector: [{ language: "bmod" }],
    // The lenses of the server run their commands here, in a terminal.
    middleware: {
      executeCommand: (command, args, next) =>
        command === "bmod.run" || command === "bmod.why" ? inTerminal(command.slice(5), args[0]) : next(command, args),
    },
  };
  client = new LanguageClient("bmod", "bmod", server, options);
  try {
    await client.start();
  } catch (e) {
    vscode.window.showErrorMessage(`bmod cannot be started (${program()}): ${e?.message ?? "no connection"}. Install it, or set "bmod.path".`);
  }
}

/** The file that a command is about, saved. */
async function file(given) {
  const document = vscode.window.activeTextEditor?.document;
  if (document?.isDirty) await document.save();
  return given ?? document?.uri.fsPath;
}

async function inTerminal(command, given) {
  const name = await file(given);
  if (!name) return;
  const task = new vscode.Task(
    { type: "process", task: `bmod ${command}` },
    vscode.TaskScope.Workspace,
    `${command} ${path.basename(name)}`,
    "bmod",
    new vscode.ProcessExecution(program(), [command, name], { cwd: path.dirname(name) }),
  );
  task.presentationOptions = { clear: true, showReuseMessage: false };
  await vscode.tasks.executeTask(task);
}

/** Runs the model into a folder of its own and shows the SVG files it has drawn there. */
async function figures() {
  const name = await file();
  if (!name) return;
  const out = fs.mkdtempSync(path.join(os.tmpdir(), "bmod-"));
  execFile(program(), ["run", name, "--quiet", "--out", out], { cwd: path.dirname(name) }, (error, _, stderr) => {
    const drawn = fs.readdirSync(out).filter((f) => /\.(svg|png)$/i.test(f)).sort();
    if (!drawn.length) {
      const why = error ? stderr.split("\n").find((l) => l.trim()) ?? error.message : "the model draws no figure";
      vscode.window.showWarningMessage(`bmod: ${why}`);
      return;
    }
    if (!panel) {
      panel = vscode.window.createWebviewPanel("bmod.figures", "Figures", vscode.ViewColumn.Beside, {
        enableScripts: false,
        localResourceRoots: [vscode.Uri.file(os.tmpdir())],
      });
      panel.onDidDispose(() => (panel = undefined));
    }
    const escape = (s) => s.replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);
    const image = (f) => {
      const uri = panel.webview.asWebviewUri(vscode.Uri.file(path.join(out, f)));
      return `<figure><img src="${uri}" alt="${escape(f)}"><figcaption>${escape(f)}</figcaption></figure>`;
    };
    // Figures are shown as images: what a model writes is never run.
    panel.webview.html = `<!DOCTYPE html><meta http-equiv="Content-Security-Policy"
      content="default-src 'none'; img-src ${panel.webview.cspSource}; style-src 'unsafe-inline'">
      <style>img { max-width: 100%; background: white } figcaption { text-align: center }</style>${drawn.map(image).join("")}`;
    panel.title = `Figures: ${path.basename(name)}`;
    panel.reveal(undefined, true);
  });
}

exports.activate = async (context) => {
  context.subscriptions.push(
    vscode.commands.registerCommand("bmod.figures", figures),
    vscode.commands.registerCommand("bmod.restart", async () => {
      await client?.stop();
      await start();
    }),
  );
  await start();
};

exports.deactivate = () => client?.stop();
