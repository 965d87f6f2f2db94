// Simulations in a terminal.

/** Saves the file with a URI, and simulates it. The code lens of the language server calls this function. */
async function simulate(vscode, command, uri) {
  const file = vscode.Uri.parse(uri);
  const open = vscode.workspace.textDocuments.find(document => document.uri.toString() === file.toString());
  await open?.save();
  const run = new vscode.ProcessExecution(command, ['simulate', file.fsPath]);
  await vscode.tasks.executeTask(new vscode.Task({ type: 'stochc' }, vscode.TaskScope.Workspace, 'simulate', 'stochc', run, []));
}

module.exports = { simulate };
