#!/usr/bin/env python3
"""Measures the CPU time of `stochc lsp` for an edit and a request, in a program of 100,000 captures.

python3 lab/lsp/run.py [STOCHC]    needs only Python on Linux, takes a minute
"""
import json
import statistics
import subprocess
import sys
import time

STOCHC = sys.argv[1] if len(sys.argv) > 1 else "target/release/stochc"
EDGE, HEIGHT = 158, 4
ROUNDS = 5
URI = "file:///nowhere/large.sa"


def program():
    """Returns towers on a square plate, with a line for every seed and every tower."""
    towers = EDGE * EDGE
    seeds = "".join(f"        S{i} at ({i % EDGE}, {i // EDGE})\n" for i in range(towers))
    rows = (" -> ".join(f"T{i}_{level}.up" for level in range(1, HEIGHT)) for i in range(towers))
    captures = "".join(f"        S{i}.up -> {row} -> T{i}_{HEIGHT}\n" for i, row in enumerate(rows))
    return f"""scene vast from hemisphere {{
    free {towers * HEIGHT} uniform
    enclosure hemisphere {{ radius {EDGE + 10}m  wall 25 N/m }}
}}
assembly flat in vast {{
    seed plate {EDGE} x {EDGE} {{
{seeds}    }}
    phase grow {{
{captures}    }}
}}
"""


class Client:
    def __init__(self):
        self.server = subprocess.Popen([STOCHC, "lsp"], stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        # Clock of the CPU time of another process, as clock_getcpuclockid computes it.
        self.clock = (~self.server.pid << 3) | 2
        self.last = 0

    def send(self, method, params, **fields):
        body = json.dumps({"jsonrpc": "2.0", "method": method, "params": params, **fields}).encode()
        self.server.stdin.write(b"Content-Length: %d\r\n\r\n%s" % (len(body), body))
        self.server.stdin.flush()

    def receive(self, matches):
        while True:
            length = int(self.server.stdout.readline().split(b":")[1])
            self.server.stdout.readline()
            message = json.loads(self.server.stdout.read(length))
            if matches(message):
                return message

    def ask(self, method, params):
        self.last += 1
        self.send(method, params, id=self.last)
        answer = self.receive(lambda it: it.get("id") == self.last and "method" not in it)
        assert "error" not in answer, answer
        return answer["result"]

    def cpu(self):
        return time.clock_gettime(self.clock)


text = program()
line = text[: text.index(f"S{EDGE * EDGE // 2}.up")].count("\n")
end = len(text.split("\n")[line])
document = {"textDocument": {"uri": URI}}
here = {**document, "position": {"line": line, "character": end}}
screen = {"start": {"line": line - 20, "character": 0}, "end": {"line": line + 20, "character": 0}}
REQUESTS = {
    "hover": here,
    "completion": here,
    "definition": here,
    "documentHighlight": here,
    "documentSymbol": document,
    "documentLink": document,
    "foldingRange": document,
    "codeLens": document,
    "inlayHint": {**document, "range": screen},
    "semanticTokens/full": document,
    "semanticTokens/range": {**document, "range": screen},
    "diagnostic": document,
    "codeAction": {**document, "range": {"start": here["position"], "end": here["position"]}, "context": {"diagnostics": []}},
}

client = Client()
refresh = {"refreshSupport": True}
workspace = {area: refresh for area in ("semanticTokens", "inlayHint", "codeLens", "diagnostics")}
capabilities = {"textDocument": {"diagnostic": {}}, "workspace": workspace}
offered = client.ask("initialize", {"capabilities": capabilities})["capabilities"]
if not isinstance(offered["semanticTokensProvider"].get("range"), bool):
    del REQUESTS["semanticTokens/range"]
client.send("initialized", {})
client.send("textDocument/didOpen", {"textDocument": {"uri": URI, "languageId": "stochc", "version": 1, "text": text}})
before = client.cpu()
client.ask("textDocument/diagnostic", document)
print(f"{len(text) / 1e6:.1f} MB, first check: {client.cpu() - before:.2f} s of CPU time")
version = 1
for method, params in REQUESTS.items():
    times = []
    for _ in range(ROUNDS):
        version += 1
        # Alternately inserts and removes the last character of a name.
        old, new = ("", "x") if version % 2 == 0 else ("x", "")
        change = {"start": here["position"], "end": {"line": line, "character": end + len(old)}}
        before = client.cpu()
        client.send("textDocument/didChange", {
            "textDocument": {"uri": URI, "version": version},
            "contentChanges": [{"range": change, "text": new}],
        })
        client.ask(f"textDocument/{method}", params)
        times.append(client.cpu() - before)
        # The next edit follows the check.
        client.ask("textDocument/references", {**here, "context": {"includeDeclaration": True}})
    print(f"{method:22} {statistics.median(times):.3f} s, at most {max(times):.3f} s")
client.ask("shutdown", None)
client.send("exit", None)
