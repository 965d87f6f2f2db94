// Commands for a file in a terminal.

/** Saves the file with a URI, and runs a subcommand on it. The code lenses of the language server call this function. */
async function run(vscode, command, subcommand, uri) {
  const file = vscode.Uri.parse(uri);
  const open = vscode.workspace.textDocuments.find(document => document.uri.toString() === file.toString());
  await open?.save();
  const process = new vscode.ProcessExecution(command, [subcommand, file.fsPath]);
  await vscode.tasks.executeTask(new vscode.Task({ type: 'stochc' }, vscode.TaskScope.Workspace, subcommand, 'stochc', process, []));
}

module.exports = { run };
