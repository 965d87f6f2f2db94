// Starts the language server, and shows structures.
const vscode = require('vscode');
const { LanguageClient } = require('vscode-languageclient/node');
const { run } = require('./simulation');
const { page, programs } = require('./structure');

const command = () => vscode.workspace.getConfiguration('stochc').get('path') || 'stochc';

let client;

/** Starts the language server, or starts it again. */
async function start() {
  await client?.dispose();
  client = new LanguageClient(
    'stochc',
    'stochc',
    { command: command(), args: ['lsp'] },
    { documentSelector: [{ language: 'stochc' }] },
  );
  try {
    await client.start();
  } catch (error) {
    vscode.window.showErrorMessage(`Cannot start \`${command()} lsp\`: ${error.message}. Set "stochc.path" in the settings.`);
  }
}

/** Shows the structure of the saved program next to the editor, and draws it again after each save. */
async function showStructure() {
  const document = vscode.window.activeTextEditor?.document;
  if (document?.languageId !== 'stochc' || document.isUntitled) {
    vscode.window.showInformationMessage('Open and save a program first.');
    return;
  }
  await document.save();
  const names = programs(document.getText());
  const program = names.length > 1 ? await vscode.window.showQuickPick(names, { title: 'Program' }) : names[0];
  if (names.length > 1 && !program) return;

  const beside = { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true };
  const panel = vscode.window.createWebviewPanel('stochc.structure', `Structure of ${program ?? 'program'}`, beside);
  const draw = async () => {
    panel.webview.html = await page(command(), document.fileName, program);
  };
  const saved = vscode.workspace.onDidSaveTextDocument(changed => changed.languageId === 'stochc' && draw());
  panel.onDidDispose(() => saved.dispose());
  await draw();
}

async function activate(context) {
  context.subscriptions.push(
    vscode.commands.registerCommand('stochc.showStructure', showStructure),
    vscode.commands.registerCommand('stochc.simulate', uri => run(vscode, command(), 'simulate', uri)),
    vscode.commands.registerCommand('stochc.test', uri => run(vscode, command(), 'test', uri)),
    vscode.commands.registerCommand('stochc.restart', start),
    vscode.workspace.onDidChangeConfiguration(changed => changed.affectsConfiguration('stochc.path') && start()),
  );
  await start();
}

const deactivate = () => client?.dispose();

module.exports = { activate, deactivate };
