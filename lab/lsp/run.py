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

    def receive(self):
        length = int(self.server.stdout.readline().split(b":")[1])
        self.server.stdout.readline()
        return self.server.stdout.read(length)

    def ask(self, *requests):
        """Sends requests. Returns the CPU time until the last answer, and its result."""
        first = self.last + 1
        for method, params in requests:
            self.last += 1
            self.send(method, params, id=self.last)
        waiting = set(range(first, self.last + 1))
        while waiting:
            body = self.receive()
            # Parsing takes so long that the server may begin its check.
            until = self.cpu()
            message = json.loads(body)
            if "method" not in message:
                assert "error" not in message, message
                waiting.remove(message["id"])
        return until, message["result"]

    def cpu(self):
        return time.clock_gettime(self.clock)


text = program()
line = text[: text.index(f"S{EDGE * EDGE // 2}.up")].count("\n")
end = len(text.split("\n")[line])
document = {"textDocument": {"uri": URI}}
here = {**document, "position": {"line": line, "character": end}}
above = {**document, "position": {"line": line - 1, "character": 8}}
screen = {"start": {"line": line - 20, "character": 0}, "end": {"line": line + 20, "character": 0}}
REQUESTS = {
    "hover": above,
    "completion": here,
    "definition": above,
    "documentHighlight": above,
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
_, offered = client.ask(("initialize", {"capabilities": capabilities}))
if not isinstance(offered["capabilities"]["semanticTokensProvider"].get("range"), bool):
    del REQUESTS["semanticTokens/range"]
client.send("initialized", {})
client.send("textDocument/didOpen", {"textDocument": {"uri": URI, "languageId": "stochc", "version": 1, "text": text}})
before = client.cpu()
until, _ = client.ask(("textDocument/diagnostic", document))
print(f"{len(text) / 1e6:.1f} MB, first check: {until - before:.2f} s of CPU time")
version = 1
# Requests of an editor after each edit.
AUTOMATIC = [method for method in REQUESTS if method not in ("hover", "completion", "definition", "semanticTokens/range")]
for methods in [*([method] for method in REQUESTS), AUTOMATIC]:
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
        until, _ = client.ask(*((f"textDocument/{method}", REQUESTS[method]) for method in methods))
        times.append(until - before)
        # The next edit follows the check.
        client.ask(("textDocument/references", {**above, "context": {"includeDeclaration": True}}))
    name = methods[0] if len(methods) == 1 else f"{len(methods)} automatic ones"
    print(f"{name:20} {statistics.median(times):.3f} s, at most {max(times):.3f} s")
client.ask(("shutdown", None))
client.send("exit", None)
